// The pictures of docs/theory, drawn by the library that they explain:
//   build/release/figures docs/theory/figures [page ...]
// The tables of numbers behind the convergence plots are printed.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>
#include <vector>

#include "scenes.h"

int main(int argc, char** argv) {
  using namespace penumbra::figures;
  struct Page {
    std::string_view name;
    void (*draw)(const std::filesystem::path&);
  };
  constexpr std::array<Page, 8> pages{{{"point", draw_point},
                                       {"nusselt", draw_nusselt},
                                       {"hemicube", draw_hemicube},
                                       {"analytic", draw_analytic},
                                       {"adaptive", draw_adaptive},
                                       {"ray_cast", draw_ray_cast},
                                       {"bsp_tree", draw_bsp_tree},
                                       {"auto", draw_auto}}};
  if (argc < 2) {
    fmt::print(stderr,
               "usage: figures FOLDER [page ...]; pages: point nusselt hemicube analytic adaptive ray_cast "
               "bsp_tree auto\n");
    return 2;
  }
  const std::vector<std::string_view> wanted(argv + 2, argv + argc);
  try {
    for (const Page& page : pages) {
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), page.name) == wanted.end()) continue;
      fmt::print("{}\n", page.name);
      page.draw(argv[1]);
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "figures: {}\n", e.what());
    return 1;
  }
  return 0;
}
