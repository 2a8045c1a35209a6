// SPDX-License-Identifier: Apache-2.0
//
// A set of cells in a window of a grid, a bit for each: rows of words of 64 columns. The memory is reused from one set
// to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace survey {

class CellBits {
 public:
  static constexpr int kColumns = 64;  // of a word

  // The empty set in a window that holds these rows and columns, last ones included; they must not be negative.
  void Reset(int first_row, int last_row, int first_column, int last_column) {
    first_row_ = first_row;
    first_word_ = first_column / kColumns;
    num_words_ = static_cast<std::size_t>(last_column / kColumns - first_word_ + 1);
    words_.assign(num_words_ * static_cast<std::size_t>(last_row - first_row + 1), 0);
  }

  // A row to which cells are added.
  class Line {
   public:
    void Add(int column) { words_[WordOf(column)] |= std::uint64_t{1} << BitOf(column); }

    // Columns first ... last, both included.
    void Add(int first, int last) {
      const std::size_t first_word = WordOf(first);
      const std::size_t last_word = WordOf(last);
      const std::uint64_t from_first = ~std::uint64_t{0} << BitOf(first);
      const std::uint64_t up_to_last = ~std::uint64_t{0} >> (kColumns - 1 - BitOf(last));
      if (first_word == last_word) {
        words_[first_word] |= from_first & up_to_last;
        return;
      }
      words_[first_word] |= from_first;
      for (std::size_t word = first_word + 1; word < last_word; ++word) words_[word] = ~std::uint64_t{0};
      words_[last_word] |= up_to_last;
    }

    // To the row above (1) or below (-1).
    void Move(int direction) { words_ += direction * num_words_; }

   private:
    friend class CellBits;
    Line(std::uint64_t* words, std::ptrdiff_t num_words, unsigned first_word)
        : words_(words), num_words_(num_words), first_word_(first_word) {}
    std::size_t WordOf(int column) const { return static_cast<unsigned>(column) / kColumns - first_word_; }
    static unsigned BitOf(int column) { return static_cast<unsigned>(column) % kColumns; }

    std::uint64_t* words_;
    std::ptrdiff_t num_words_;
    unsigned first_word_;
  };

  Line LineOf(int row) {
    return {words_.data() + static_cast<std::size_t>(row - first_row_) * num_words_,
            static_cast<std::ptrdiff_t>(num_words_), static_cast<unsigned>(first_word_)};
  }

  // Words of a row; bit b of word w is column FirstColumn() + 64 w + b.
  std::span<const std::uint64_t> Row(int row) const {
    return std::span(words_).subspan(static_cast<std::size_t>(row - first_row_) * num_words_, num_words_);
  }
  int FirstColumn() const { return first_word_ * kColumns; }

 private:
  int first_row_ = 0;
  int first_word_ = 0;
  std::size_t num_words_ = 0;  // of a row
  std::vector<std::uint64_t> words_;
};

}  // namespace survey
