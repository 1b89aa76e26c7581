#!/usr/bin/env node
// Shows a .glb in a stock viewer, in headless Chromium, and takes a picture of it.
//   tools/show_in_viewer.mjs FILE.glb -o OUT.png [--viewer three|model-viewer|babylon] [--size WxH]
//     [--eye x,y,z --look-at x,y,z --fov DEG] [--lightmap FILE.exr --lightmap-scale X]
// Without --eye the file's first camera looks (model-viewer: its own framing). --lightmap (three) shows the light of
// `penumbra bake --profile lightmap`. Needs Debian's chromium; installs the viewers (npm ci, by their lock file) into
// build/viewers the first time.
import { execFileSync } from 'node:child_process';
import { copyFileSync, createReadStream, existsSync, mkdirSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { dirname, extname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const recipe = join(dirname(fileURLToPath(import.meta.url)), 'viewers');
const home = resolve(recipe, '../../build/viewers');
const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm', '.glb': 'model/gltf-binary' };

function installViewers() {
  const lock = 'package-lock.json';
  const current = existsSync(join(home, 'node_modules/three')) && existsSync(join(home, lock)) &&
    readFileSync(join(home, lock), 'utf8') === readFileSync(join(recipe, lock), 'utf8');
  if (current) return;
  mkdirSync(home, { recursive: true });
  for (const file of ['package.json', lock]) copyFileSync(join(recipe, file), join(home, file));
  execFileSync('npm', ['ci', '--no-audit', '--no-fund', '--silent'], { cwd: home, stdio: ['ignore', 2, 2] });
}

// The pages, the viewers' modules, and the files shown under fixed names.
function serve(files) {
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
    const file = files[path] ?? (path.startsWith('/modules/') ? join(home, 'node_modules', path.slice(9)) : join(recipe, path));
    if (!existsSync(file)) { response.writeHead(404).end(); return; }
    response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
    createReadStream(file).pipe(response);
  });
  return new Promise((done) => { server.listen(0, '127.0.0.1', () => done(server)); });
}

async function takePicture(url, size, output) {
  const { chromium } = createRequire(join(home, 'package.json'))('playwright-core');
  const browser = await chromium.launch({
    executablePath: '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--no-first-run', '--force-color-profile=srgb'],
  });
  try {
    const page = await browser.newPage({ viewport: size });
    const said = [];
    page.on('pageerror', (error) => said.push(error.message));
    page.on('console', (message) => { if (message.type() === 'error') said.push(message.text()); });
    await page.goto(url);
    await page.waitForFunction('window.shown || window.failed', undefined, { timeout: 120_000 })
      .catch(() => { throw new Error(`the viewer did not show the file within two minutes. ${said.join('; ')}`); });
    const failed = await page.evaluate('window.failed');
    if (failed) throw new Error(failed);
    await page.screenshot({ path: output });
  } finally {
    await browser.close();
  }
}

const numbers = (text) => text?.split(',').map(Number);
const { values: o, positionals: [model] } = parseArgs({ allowPositionals: true, options: {
  output: { type: 'string', short: 'o' }, viewer: { type: 'string', default: 'three' },
  size: { type: 'string', default: '512x512' }, eye: { type: 'string' }, 'look-at': { type: 'string', default: '0,0,0' },
  fov: { type: 'string', default: '45' }, lightmap: { type: 'string' }, 'lightmap-scale': { type: 'string', default: '1' } } });
if (!model || !o.output || !existsSync(join(recipe, `${o.viewer}.html`))) {
  console.error('usage: show_in_viewer.mjs FILE.glb -o OUT.png [--viewer three|model-viewer|babylon] ...; see its first lines');
  process.exit(2);
}
installViewers();
const [width, height] = o.size.split('x').map(Number);
const wish = { width, height, eye: numbers(o.eye), lookAt: numbers(o['look-at']), fov: Number(o.fov),
  lightmap: o.lightmap && '/light.exr', lightmapScale: Number(o['lightmap-scale']) };
const server = await serve({ '/model.glb': resolve(model), ...(o.lightmap && { '/light.exr': resolve(o.lightmap) }) });
try {
  const hash = encodeURIComponent(JSON.stringify(wish));
  await takePicture(`http://127.0.0.1:${server.address().port}/${o.viewer}.html#${hash}`, { width, height }, o.output);
} catch (error) {
  console.error(`${model} in ${o.viewer}: ${error.message}`);
  process.exitCode = 1;
} finally {
  server.close();
}
