// SPDX-License-Identifier: Apache-2.0
//
// Items of a batch, listed by the row they belong to: a linked list per row in two arrays whose memory is reused.
#pragma once

#include <cstddef>
#include <vector>

namespace survey {

template <typename Item>
class RowLists {
 public:
  // Rows 0 ... num_rows - 1, all empty.
  void Reset(int num_rows) {
    first_.assign(static_cast<std::size_t>(num_rows), kNone);
    entries_.clear();
  }

  void Add(int row, const Item& item) {
    int& first = first_[static_cast<std::size_t>(row)];
    entries_.push_back({item, first});
    first = static_cast<int>(entries_.size()) - 1;
  }

  // The last added comes first.
  template <typename Visit>
  void ForEach(int row, const Visit& visit) const {
    for (int i = first_[static_cast<std::size_t>(row)]; i != kNone; i = entries_[static_cast<std::size_t>(i)].next)
      visit(entries_[static_cast<std::size_t>(i)].item);
  }

 private:
  static constexpr int kNone = -1;
  struct Entry {
    Item item;
    int next;
  };
  std::vector<int> first_;  // by row
  std::vector<Entry> entries_;
};

}  // namespace survey
