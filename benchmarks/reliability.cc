// SPDX-License-Identifier: Apache-2.0
//
// Monte Carlo of the tests of control: plumbline-reliability [RUNS], 500 without. Prints what was found against what
// was planted in simulated garage blocks.
#include <cmath>
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
  print("two labels exchanged: named", counts.exchanges_named, runs);
  print("and no other mark left out", counts.exchanges_alone, runs);
  print("a mark 0.5 s off: this mark and no other left out", counts.times_found, runs);
  print("and its sentence says 0.5 s", counts.times_named, runs);
  print("without loops, sigmas x 10: blocks that lost a mark", counts.unlooped_rejected, runs);
  print("true places within the 95 % ellipse", counts.unlooped_inside, counts.ellipses);
  const auto rms_mm = [&](double sum) { return 1000.0 * std::sqrt(sum / counts.ellipses); };
  std::printf("their rms error and its sigma %.1f and %.1f mm\n", rms_mm(counts.unlooped_squared_error),
              rms_mm(counts.unlooped_variance));
  return 0;
}
