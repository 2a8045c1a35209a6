// SPDX-License-Identifier: Apache-2.0
#include "formats/noted_digest.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <sstream>

#include "formats/digest.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

constexpr off_t kWorthANote = off_t{4} << 20;  // bytes; smaller files are read in a few milliseconds

class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : descriptor_(open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  std::optional<struct stat> State() const {
    struct stat state {};
    if (descriptor_ < 0 || fstat(descriptor_, &state) != 0) return std::nullopt;
    return state;
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string TextOf(const timespec& time) { return std::to_string(time.tv_sec) + "." + std::to_string(time.tv_nsec); }

// Not the device: its number differs between the nodes of a cluster.
std::string TextOf(const struct stat& state) {
  return "inode " + std::to_string(state.st_ino) + " bytes " + std::to_string(state.st_size) + " modified " +
         TextOf(state.st_mtim) + " changed " + TextOf(state.st_ctim);
}

std::string NoteText(const struct stat& state, const std::string& digest) {
  const std::string text = TextOf(state) + " sha256 " + digest;
  return text + " check " + Sha256(text).substr(0, 16) + "\n";
}

std::optional<std::string> DigestIn(const fs::path& note, const struct stat& state) {
  std::ifstream in(note, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) return std::nullopt;
  const std::string before = TextOf(state) + " sha256 ";
  constexpr std::size_t kDigits = 64;
  if (text.str().size() < before.size() + kDigits) return std::nullopt;
  const std::string digest = text.str().substr(before.size(), kDigits);
  if (text.str() != NoteText(state, digest)) return std::nullopt;
  return digest;
}

double SecondsBetween(const timespec& from, const timespec& to) {
  return static_cast<double>(to.tv_sec - from.tv_sec) + 1e-9 * static_cast<double>(to.tv_nsec - from.tv_nsec);
}

// Whether a change from `now` on would get another time. Where times have no fraction they are whole (or even) seconds;
// elsewhere the kernel's tick is 10 ms at most.
bool IsPast(const timespec& time, const timespec& now) {
  return SecondsBetween(time, now) > (time.tv_nsec == 0 ? 2.0 : 0.02);
}

// Empties the note; what time it is by the clock of its file system.
std::optional<timespec> BeginNote(const Descriptor& note) {
  if (note.get() < 0 || futimens(note.get(), nullptr) != 0) return std::nullopt;
  const std::optional<struct stat> state = note.State();
  if (!state) return std::nullopt;
  return state->st_mtim;
}

void WriteNote(const Descriptor& note, const std::string& text) {
  if (pwrite(note.get(), text.data(), text.size(), 0) < 0) return;  // the digest holds without it
}

}  // namespace

fs::path DigestNoteOf(const fs::path& file) {
  return file.parent_path() / ("." + file.filename().string() + ".sha256");
}

std::string Sha256OfIntermediate(const fs::path& file) {
  // Opened first: only then is the state of a file on a network what its server says.
  const std::optional<struct stat> before = Descriptor(file, O_RDONLY).State();
  if (!before || !S_ISREG(before->st_mode) || before->st_size < kWorthANote) return Sha256OfFile(file);
  const fs::path note_file = DigestNoteOf(file);
  if (const std::optional<std::string> noted = DigestIn(note_file, *before)) return *noted;
  const Descriptor note(note_file, O_WRONLY | O_CREAT | O_TRUNC);
  const std::optional<timespec> now = BeginNote(note);
  const std::string digest = Sha256OfFile(file);
  const std::optional<struct stat> after = Descriptor(file, O_RDONLY).State();
  if (now && after && TextOf(*after) == TextOf(*before) && IsPast(before->st_mtim, *now) &&
      IsPast(before->st_ctim, *now))
    WriteNote(note, NoteText(*before, digest));
  return digest;
}

}  // namespace formats
