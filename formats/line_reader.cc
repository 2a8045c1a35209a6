// SPDX-License-Identifier: Apache-2.0
#include "formats/line_reader.h"

#include <cstring>

#include "formats/errors.h"

namespace formats {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 26;

}  // namespace

LineReader::LineReader(std::filesystem::path file) : file_(std::move(file)), buffer_(kBlock) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) throw DataError(file_.string() + ": no such file");
  if (std::filesystem::is_directory(file_, error)) throw DataError(file_.string() + ": is a folder, expected a file");
  in_.open(file_, std::ios::binary);
  if (!in_) throw DataError(file_.string() + ": cannot be read");
  Fill();
  const std::string_view start(buffer_.data(), end_);
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF"))
    throw DataError(file_.string() + ": is UTF-16 text; save it as UTF-8");
  if (start.starts_with("\xEF\xBB\xBF")) begin_ = 3;
}

std::string LineReader::Where() const { return file_.string() + ":" + std::to_string(line_number_); }

bool LineReader::Fill() {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    if (buffer_.size() >= kLongestLine)
      throw DataError(file_.string() + ":" + std::to_string(line_number_ + 1) + ": is not a text file (endless line)");
    buffer_.resize(buffer_.size() * 2);
  }
  in_.read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  if (in_.bad()) throw DataError(file_.string() + ": cannot be read to its end");
  const auto count = static_cast<std::size_t>(in_.gcount());
  end_ += count;
  return count > 0;
}

bool LineReader::Next(std::string_view* line) {
  std::size_t searched = 0;
  const char* found = nullptr;
  do {
    const char* start = buffer_.data() + begin_;
    found = static_cast<const char*>(std::memchr(start + searched, '\n', end_ - begin_ - searched));
    searched = end_ - begin_;
  } while (found == nullptr && Fill());
  if (found == nullptr && begin_ == end_) return false;

  const char* start = buffer_.data() + begin_;
  std::size_t length = found != nullptr ? static_cast<std::size_t>(found - start) : end_ - begin_;
  begin_ += length + (found != nullptr ? 1 : 0);
  line_ended_ = found != nullptr;
  ++line_number_;
  if (std::memchr(start, '\0', length) != nullptr) throw DataError(Where() + ": is not a text file (holds zero bytes)");
  if (length > 0 && start[length - 1] == '\r') --length;
  *line = {start, length};
  return true;
}

}  // namespace formats
