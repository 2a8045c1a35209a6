// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_bag_file.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <fstream>
#include <map>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kLargestChunk = std::size_t{1} << 30;

enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

using Fields = std::map<std::string, std::string, std::less<>>;

Fields ParseFields(std::string_view bytes) {
  Fields fields;
  ByteReader reader(bytes);
  while (!reader.empty()) {
    const std::string_view field = reader.Sized();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw DataError("a header field without '='");
    fields[std::string(field.substr(0, equals))] = std::string(field.substr(equals + 1));
  }
  return fields;
}

const std::string& Text(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) throw DataError("a record without the field " + std::string(name));
  return found->second;
}

template <typename T>
T Number(const Fields& fields, std::string_view name) {
  return ByteReader(Text(fields, name)).Read<T>();
}

std::string DecompressBzip2(std::string_view data, std::size_t size) {
  std::string out(size, '\0');
  auto out_size = static_cast<unsigned int>(size);
  // The library takes its input as non-const, but does not write to it.
  const int status = BZ2_bzBuffToBuffDecompress(out.data(), &out_size, const_cast<char*>(data.data()),
                                                static_cast<unsigned int>(data.size()), 0, 0);
  if (status != BZ_OK || out_size != size) throw DataError("a chunk cannot be decompressed (bzip2)");
  return out;
}

std::string DecompressLz4(std::string_view data, std::size_t size) {
  std::string out(size, '\0');
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
    throw std::runtime_error("no LZ4 decompression context");
  std::size_t written = 0;
  std::size_t status = 1;
  while (status != 0 && !data.empty()) {
    std::size_t in_size = data.size();
    std::size_t out_size = size - written;
    status = LZ4F_decompress(context, out.data() + written, &out_size, data.data(), &in_size, nullptr);
    if (LZ4F_isError(status) || (in_size == 0 && out_size == 0)) break;
    data.remove_prefix(in_size);
    written += out_size;
  }
  LZ4F_freeDecompressionContext(context);
  if (status != 0 || written != size) throw DataError("a chunk cannot be decompressed (LZ4)");
  return out;
}

class BagFile {
 public:
  BagFile(const fs::path& file, const std::function<void(const BagConnection&, std::string_view)>& visit)
      : in_(file, std::ios::binary), visit_(visit) {
    if (!in_) throw DataError("cannot be read");
    in_.seekg(0, std::ios::end);
    left_ = static_cast<std::uint64_t>(in_.tellg());
    in_.seekg(0);
    if (left_ < kMagic.size() || Take(kMagic.size()) != kMagic) throw DataError("is not a ROS bag of format 2.0");
  }

  // Returns whether the file ends within a record of a recording that was not closed.
  bool ReadAll() {
    while (left_ > 0) {
      try {
        ReadRecord();
      } catch (const ByteReader::EndOfData&) {
        if (closed_) throw DataError("is truncated: it ends within a record");
        return true;
      }
    }
    return !closed_;
  }

 private:
  std::string Take(std::uint64_t count) {
    if (count > left_) throw ByteReader::EndOfData();
    std::string bytes(static_cast<std::size_t>(count), '\0');
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!in_) throw DataError("cannot be read to its end");
    left_ -= count;
    return bytes;
  }

  std::string TakeSized() {
    const std::string length = Take(sizeof(std::uint32_t));
    return Take(ByteReader(length).Read<std::uint32_t>());
  }

  void ReadRecord() {
    const std::string header = TakeSized();
    const Fields fields = ParseFields(header);
    switch (Number<std::uint8_t>(fields, "op")) {
      case kBagHeader: {
        // The index position is filled in when a recording is closed.
        closed_ = Number<std::uint64_t>(fields, "index_pos") != 0;
        const auto encryptor = fields.find("encryptor");
        if (encryptor != fields.end() && !encryptor->second.empty()) throw DataError("is encrypted");
        TakeSized();
        return;
      }
      case kIndex: {
        // Some programs write a wrong length here; the number of entries of 12 bytes is what counts.
        Take(sizeof(std::uint32_t));
        Take(std::uint64_t{12} * Number<std::uint32_t>(fields, "count"));
        return;
      }
      case kChunk:
        ReadChunk(fields, TakeSized());
        return;
      case kMessage:
      case kConnection:
        ReadContent(fields, TakeSized());
        return;
      default:
        TakeSized();
    }
  }

  void ReadChunk(const Fields& fields, const std::string& data) {
    const std::string& compression = Text(fields, "compression");
    const std::size_t size = Number<std::uint32_t>(fields, "size");
    if (size > kLargestChunk) throw DataError("a chunk of more than 1 GB");
    if (compression == "none") {
      ReadRecords(data);
    } else if (compression == "bz2") {
      ReadRecords(DecompressBzip2(data, size));
    } else if (compression == "lz4") {
      ReadRecords(DecompressLz4(data, size));
    } else {
      throw DataError("a chunk of unknown compression \"" + compression + "\"");
    }
  }

  void ReadRecords(std::string_view chunk) {
    ByteReader reader(chunk);
    try {
      while (!reader.empty()) {
        const Fields fields = ParseFields(reader.Sized());
        ReadContent(fields, reader.Sized());
      }
    } catch (const ByteReader::EndOfData&) {
      throw DataError("a chunk ends within a record");
    }
  }

  void ReadContent(const Fields& fields, std::string_view data) {
    const auto op = Number<std::uint8_t>(fields, "op");
    if (op != kMessage && op != kConnection) return;
    const auto id = Number<std::uint32_t>(fields, "conn");
    if (op == kConnection) {
      const Fields description = ParseFields(data);
      connections_[id] = {Text(fields, "topic"), Text(description, "type"), Text(description, "md5sum")};
      return;
    }
    const auto found = connections_.find(id);
    if (found == connections_.end()) throw DataError("a message of a connection that is not described");
    visit_(found->second, data);
  }

  std::ifstream in_;
  std::uint64_t left_ = 0;
  bool closed_ = false;
  std::map<std::uint32_t, BagConnection> connections_;
  const std::function<void(const BagConnection&, std::string_view)>& visit_;
};

}  // namespace

std::string ReadBagMessages(const fs::path& file,
                            const std::function<void(const BagConnection&, std::string_view)>& visit) {
  std::error_code error;
  if (!fs::exists(file, error)) throw DataError(file.string() + ": no such file");
  if (fs::is_directory(file, error)) throw DataError(file.string() + ": is a folder, expected a file");
  try {
    const bool end_missing = BagFile(file, visit).ReadAll();
    return end_missing ? file.string() + ": the recording was not closed; messages at its end may be missing" : "";
  } catch (const DataError& problem) {
    throw DataError(file.string() + ": " + problem.what());
  } catch (const ByteReader::EndOfData&) {
    throw DataError(file.string() + ": is truncated or damaged");
  }
}

}  // namespace formats
