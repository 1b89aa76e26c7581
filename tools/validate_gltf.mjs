#!/usr/bin/env node
// Runs the Khronos glTF validator over files, or over every built-in scene when none is named.
//   tools/validate_gltf.mjs [FILE.glb ...]
// Prints each issue and a line a file; exits 1 when there is an error. Installs the validator (npm ci, by its lock file)
// into build/gltf_validator the first time.
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const severities = ['error', 'warning', 'information', 'hint'];

function installedValidator() {
  const recipe = join(root, 'tools/gltf_validator');
  const home = join(root, 'build/gltf_validator');
  const lock = 'package-lock.json';
  const installed = join(home, 'node_modules/gltf-validator');
  const current = existsSync(installed) && existsSync(join(home, lock)) &&
    readFileSync(join(home, lock), 'utf8') === readFileSync(join(recipe, lock), 'utf8');
  if (!current) {
    mkdirSync(home, { recursive: true });
    for (const file of ['package.json', lock]) copyFileSync(join(recipe, file), join(home, file));
    execFileSync('npm', ['ci', '--no-audit', '--no-fund', '--silent'], { cwd: home, stdio: ['ignore', 2, 2] });
  }
  return createRequire(join(home, 'package.json'))('gltf-validator');
}

// One file a built-in scene, the atrium in two sizes so that both widths of indices are seen.
function builtinScenes(folder) {
  const program = join(root, 'build/release/penumbra');
  const listed = JSON.parse(execFileSync(program, ['scene', '--list', '--json'], { encoding: 'utf8' }));
  const sources = [...listed.scenes.map((scene) => scene.name), 'atrium?triangles=500000'];
  return sources.map((source) => {
    const file = join(folder, `${source.replace(/[?=&]/g, '-')}.glb`);
    execFileSync(program, ['scene', source, '-o', file, '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
    return file;
  });
}

async function validate(validator, file) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { uri: basename(file) });
  for (const issue of report.issues.messages) {
    console.log(`${file}: ${severities[issue.severity]}: ${issue.code}: ${issue.message} (${issue.pointer ?? 'file'})`);
  }
  const { numErrors, numWarnings, numInfos } = report.issues;
  console.log(`${basename(file)}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes, ` +
    `${report.info?.totalTriangleCount ?? 0} triangles`);
  return numErrors;
}

const validator = installedValidator();
const folder = mkdtempSync(join(tmpdir(), 'penumbra-gltf-'));
try {
  const files = process.argv.length > 2 ? process.argv.slice(2) : builtinScenes(folder);
  let errors = 0;
  for (const file of files) errors += await validate(validator, file);
  console.log(`${files.length} files, ${errors} errors`);
  process.exitCode = errors > 0 || files.length === 0 ? 1 : 0;
} finally {
  rmSync(folder, { recursive: true, force: true });
}
