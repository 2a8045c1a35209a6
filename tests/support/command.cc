// SPDX-License-Identifier: Apache-2.0
#include "tests/support/command.h"

#include <sys/wait.h>

#include <cstdlib>

#include "formats/atomic_file.h"
#include "tests/support/paths.h"
#include "tests/support/scratch_folder.h"

namespace test_support {
namespace {

std::string Quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

CommandResult RunCommand(const std::vector<std::string>& command, const std::string& working_folder) {
  const ScratchFolder scratch;
  std::string line = "cd " + Quoted(working_folder) + " && WEASYPRINT= PATH=" + Quoted(BinFolder()) + ":\"$PATH\"";
  for (const std::string& word : command) line += " " + Quoted(word);
  line += " >" + Quoted(scratch / "out") + " 2>" + Quoted(scratch / "err") + " </dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), formats::ReadWholeFile(scratch / "out"),
          formats::ReadWholeFile(scratch / "err")};
}

}  // namespace test_support
