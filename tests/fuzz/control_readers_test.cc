// SPDX-License-Identifier: Apache-2.0
//
// Damaged control files of other programs: what is read can be adjusted or is refused; nothing crashes.
#include <gtest/gtest.h>

#include <fstream>

#include "formats/atomic_file.h"
#include "formats/control_source.h"
#include "formats/errors.h"
#include "survey/network/control_of_network.h"
#include "survey/stats/philox.h"
#include "tests/support/scratch_folder.h"

namespace {

const std::string kGkf =
    "<gama-local><network axes-xy='en' angles='left-handed'><parameters sigma-apr='1'/>\n"
    "<points-observations distance-stdev='1' direction-stdev='5'>\n"
    "<point id='A' x='0' y='0' z='0' fix='xyz'/><point id='B' x='100' y='0' fix='xy'/><point id='C' adj='xyz'/>\n"
    "<obs from='A'><direction to='B' val='100.0000'/><direction to='C' val='50.0003'/><distance to='C' "
    "val='70.7107'/>\n"
    "<z-angle to='C' val='90-00-00' stdev='5'/></obs>\n"
    "<obs from='B'><direction to='A' val='0'/><direction to='C' val='49.9999'/><distance to='C' val='70.7110'/>\n"
    "<cov-mat dim='3' band='1'>25 0 25 0 1</cov-mat></obs>\n"
    "<height-differences><dh from='A' to='C' val='0.001' dist='0.1'/></height-differences>\n"
    "</points-observations></network></gama-local>\n";

const std::string kStarnet =
    ".UNITS METERS\n.3D\n.ORDER NE\nC A 0 0 0 ! ! !\nC B 0 100 0 ! ! !\nDB A\nDN B 0-00-00 5\n"
    "DM C 315-00-00 70.7107 90-00-00 5 0.001 5 1.5/1.5\nDE\nTB A\nT B 270-00-00 50 90-00-00 5 0.001 5\nTE D\n"
    "L A-C 0.001 0.1 0.002\nB B-C N45-00-00W 5\n";

const std::string kGama =
    "<gama-local-adjustment><network-general-parameters axes-xy='ne' angles='left-handed'/>\n"
    "<network-processing-summary><apriori>10</apriori><aposteriori>8</aposteriori><probability>0.95</probability>\n"
    "<degrees-of-freedom>4</degrees-of-freedom></network-processing-summary>\n"
    "<coordinates><adjusted><point><id>B</id><x>-10</x><y>-20</y></point><point><id>A</id><x>-30</x><y>-40</y></"
    "point>\n"
    "</adjusted><cov-mat><dim>4</dim><band>3</band><flt>4</flt><flt>1</flt><flt>0</flt><flt>0</flt><flt>5</flt>\n"
    "<flt>0</flt><flt>0</flt><flt>6</flt><flt>0</flt><flt>7</flt></cov-mat></coordinates></gama-local-adjustment>\n";

void ExpectReadOrRefused(const std::string& name, const std::string& whole) {
  const test_support::ScratchFolder scratch;
  const survey::RandomStream random(17, 0, 0);
  int accepted = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    std::string text = whole;
    for (std::uint64_t k = 0; i > 0 && k < 2; ++k) {
      const auto bits = random.Bits(2 * i + k);
      const std::size_t at = bits[0] % text.size();
      if (bits[1] % 8 == 0) text.resize(at + 1);
      text[at] = bits[1] % 3 == 0 ? "<>/'-0.e9\n"[bits[2] % 10] : static_cast<char>(bits[2]);
    }
    try {
      std::ofstream(scratch / name, std::ios::binary) << text;
      const formats::ControlSource source = formats::ReadControlSource(scratch / name, {});
      if (source.network) survey::AdjustControl(source.network->network, true, {});
      ++accepted;
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(accepted, 0);
}

TEST(DamagedControl, Gkf) { ExpectReadOrRefused("n.gkf", kGkf); }
TEST(DamagedControl, Starnet) { ExpectReadOrRefused("n.dat", kStarnet); }
TEST(DamagedControl, GamaAdjustment) { ExpectReadOrRefused("a.xml", kGama); }

}  // namespace
