// SPDX-License-Identifier: Apache-2.0
//
// Lines of a text file of any size, read in blocks. A byte-order mark and the CR of CRLF are taken off; UTF-16 and
// binary files are refused.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace formats {

class LineReader {
 public:
  explicit LineReader(std::filesystem::path file);  // DataError when it cannot be read

  // The next line without its end; false after the last one. The view lives until the next call.
  bool Next(std::string_view* line);

  const std::filesystem::path& file() const { return file_; }
  int line_number() const { return line_number_; }     // of the last line given, from 1
  bool line_was_ended() const { return line_ended_; }  // false: the file stops without a line end (cut off?)
  std::string Where() const;                           // "file:17"

 private:
  bool Fill();  // reads on; false at the end of the file

  std::filesystem::path file_;
  std::ifstream in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // unread part of the buffer
  std::size_t end_ = 0;
  int line_number_ = 0;
  bool line_ended_ = true;
};

}  // namespace formats
