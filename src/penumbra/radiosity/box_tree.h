#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"

namespace penumbra {

/// Boxes in a hierarchy, halved at the median of their centres along the longest axis. The same tree for the same
/// boxes.
class BoxTree {
 public:
  BoxTree() = default;
  /// @param bounds by item. @param items those that belong into the tree.
  BoxTree(std::span<const Bounds> bounds, std::vector<std::uint32_t> items, std::uint32_t leaf_size);

  /// Calls `visit(item)` for all items of leaves that no box on the way to which `misses`.
  template <class Misses, class Visit>
  void search(const Misses& misses, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::uint32_t stack[64];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const std::uint32_t number = stack[--top];
      const Node& node = nodes_[number];
      if (misses(node.bounds)) continue;
      if (node.right != 0) {
        stack[top++] = node.right;
        stack[top++] = number + 1;
        continue;
      }
      for (std::uint32_t k = node.first; k < node.last; ++k) visit(items_[k]);
    }
  }

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t first, last;  // of items_, in leaves
    std::uint32_t right = 0;    // the left child follows its parent; 0: a leaf
  };
  std::uint32_t build(std::span<const Bounds> bounds, std::uint32_t first, std::uint32_t last);

  std::uint32_t leaf_size_ = 1;
  std::vector<std::uint32_t> items_;
  std::vector<Node> nodes_;
};

}  // namespace penumbra
