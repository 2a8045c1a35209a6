// SPDX-License-Identifier: Apache-2.0
//
// Monte Carlo of the tests of control: plumbline-reliability [RUNS], 500 without. Prints what was found against what
// was planted in simulated garage blocks.
#include <cstdio>
#include <cstdlib>

#include "tests/support/garage_block.h"

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 500;
  if (runs <= 0) {
    std::fprintf(stderr, "usage: plumbline-reliability [RUNS]\n");
    return 2;
  }
  const test_support::ReliabilityCounts counts = test_support::CountReliability(1, runs);
  const auto print = [](const char* what, int count, int of) {
    std::printf("%-58s %6d of %6d  %8.3f %%\n", what, count, of, 100.0 * count / of);
  };
  print("T beyond 13.8 on a good mark (0.1 % expected)", counts.false_alarms, counts.marks_tested);
  print("clean blocks that lost a mark (0.5 % allowed)", counts.clean_rejected, runs);
  print("true places within the 95 % ellipse", counts.inside, counts.ellipses);
  print("3 x MDB in a point: this mark and no other left out", counts.blunders_named, runs);
  print("two labels exchanged: both named", counts.exchanges_named, runs);
  print("a mark 0.5 s off: this mark and no other left out", counts.times_found, runs);
  print("and its sentence says 0.5 s", counts.times_named, runs);
  return 0;
}
