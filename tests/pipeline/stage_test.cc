// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage.h"

#include <gtest/gtest.h>

#include <new>

#include "formats/atomic_file.h"
#include "pipeline/stage_program.h"
#include "tests/support/scratch_folder.h"

namespace {

namespace fs = std::filesystem;

// A stage with one option of each kind, run inside this process.
class StageTest : public testing::Test {
 protected:
  int Run(std::vector<std::string> arguments, const std::function<void(pipeline::StageRun&)>& body = {}) {
    pipeline::Stage stage("sample", "A stage for tests.", "plumbline sample --input a --output b");
    stage.Input("input", &input_, "what it reads");
    stage.Output("output", &output_, "what it writes");
    stage.Option("length-m", &length_m_, "a length (m)", {.min = 0.5, .max = 20});
    stage.Option("count", &count_, "a number of things", {.min = 1});
    stage.Option("fast", &fast_, "whether to hurry");
    stage.Option("engine", &engine_, "how", {"steam", "diesel"});
    arguments.insert(arguments.begin(), "plumbline-sample");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const int status = stage.Run(static_cast<int>(argv.size()), argv.data(), [&](pipeline::StageRun& run) {
      ran_ = true;
      if (body) body(run);
    });
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return status;
  }

  int RunWithFiles(std::vector<std::string> more, const std::function<void(pipeline::StageRun&)>& body = {}) {
    formats::WriteFileAtomically(scratch_ / "in.csv", "a,b\n1,2\n");
    more.insert(more.end(), {"--input", scratch_ / "in.csv", "--output", scratch_ / "out"});
    return Run(std::move(more), body);
  }

  std::string Config(const std::string& text) {
    formats::WriteFileAtomically(scratch_ / "config.toml", text);
    return scratch_ / "config.toml";
  }

  test_support::ScratchFolder scratch_;
  fs::path input_;
  fs::path output_;
  double length_m_ = 2;
  int count_ = 3;
  bool fast_ = false;
  std::string engine_ = "steam";
  bool ran_ = false;
  std::string out_;
  std::string err_;
};

TEST_F(StageTest, CommandLineWinsOverConfiguration) {
  const std::string config = Config("length-m = 4\ncount = 9\nfast = true\nengine = \"diesel\"\n");
  EXPECT_EQ(RunWithFiles({"--config", config, "--count", "5"}), 0) << err_;
  EXPECT_EQ(length_m_, 4);
  EXPECT_EQ(count_, 5);
  EXPECT_TRUE(fast_);
  EXPECT_EQ(engine_, "diesel");
}

TEST_F(StageTest, EffectiveOptionsEnterTheProvenance) {
  std::map<std::string, std::string> options;
  EXPECT_EQ(RunWithFiles({"--length-m", "0.50", "--threads", "2"},
                         [&](pipeline::StageRun& run) { options = run.Provenance().Own().options; }),
            0);
  EXPECT_EQ(options, (std::map<std::string, std::string>{
                         {"length-m", "0.5"}, {"count", "3"}, {"fast", "false"}, {"engine", "steam"}}));
}

TEST_F(StageTest, UsageErrorsNameTheRule) {
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& message) {
    EXPECT_EQ(RunWithFiles(arguments), 2) << message;
    EXPECT_NE(err_.find(message), std::string::npos) << err_;
    EXPECT_FALSE(ran_);
  };
  expect({"--length-m", "0.4"}, "length-m = 0.4: must be between 0.5 and 20");
  expect({"--length-m", "nan"}, "length-m: must be a finite number");
  expect({"--length-m", "long"}, "long");
  expect({"--length-m", "3", "--count", "0"}, "count = 0: must be at least 1");
  expect({"--count", "1.5"}, "1.5");
  expect({"--count", "1", "--engine", "petrol"}, "engine = \"petrol\": must be one of steam, diesel");
  expect({"--lenght-m", "3"}, "--lenght-m");
  expect({"--config", Config("lenght-m = 3\n")}, "config.toml:1: lenght-m: unknown key; did you mean length-m?");
  expect({"--config", Config("\ncount = \"three\"\n")}, "config.toml:2: count: expected an integer");
  expect({"--config", Config("count = \n")}, "config.toml:1: ");
}

TEST_F(StageTest, MissingFilesAreToldBeforeTheBodyRuns) {
  EXPECT_EQ(Run({"--output", "x"}), 2);
  EXPECT_NE(err_.find("--input is required"), std::string::npos);
  EXPECT_EQ(Run({"--input", scratch_ / "nothing", "--output", "x"}), 1);
  EXPECT_NE(err_.find("nothing: no such file (--input)"), std::string::npos);
  EXPECT_EQ(Run({"--input", scratch_.path().string(), "--output", "x"}), 1);
  EXPECT_NE(err_.find("is a folder"), std::string::npos);
  input_.clear();
  output_.clear();
  formats::WriteFileAtomically(scratch_ / "in.csv", "1\n");
  EXPECT_EQ(Run({"--input", scratch_ / "in.csv"}), 2);
  EXPECT_NE(err_.find("--output is required"), std::string::npos);
  EXPECT_FALSE(ran_);
}

TEST_F(StageTest, FailuresBecomeExitStatuses) {
  const auto failing = [&](const std::function<void()>& body) {
    return RunWithFiles({}, [&](pipeline::StageRun&) { body(); });
  };
  EXPECT_EQ(failing([] { throw formats::DataError("points.csv:7: bad"); }), 1);
  EXPECT_EQ(err_, "plumbline-sample: points.csv:7: bad\n");
  EXPECT_EQ(failing([] { throw formats::UsageError("no"); }), 2);
  EXPECT_EQ(failing([] { throw std::bad_alloc(); }), 1);
  EXPECT_NE(err_.find("out of memory"), std::string::npos);
  EXPECT_EQ(failing([] { static_cast<void>(fs::file_size("/nowhere")); }), 1);
  EXPECT_NE(err_.find("/nowhere: No such file"), std::string::npos) << err_;
  EXPECT_EQ(failing([] { throw std::logic_error("impossible"); }), 3);
  EXPECT_NE(err_.find("internal error: impossible"), std::string::npos);
}

TEST_F(StageTest, LogTellsTheOutcome) {
  const fs::path log = scratch_ / "logs/sample.log";
  std::string during;
  EXPECT_EQ(RunWithFiles({"--log", log, "--quiet"},
                         [&](pipeline::StageRun& run) {
                           run.Message("half way");
                           during = formats::ReadWholeFile(log);
                         }),
            0);
  EXPECT_EQ(err_, "");
  EXPECT_NE(during.find("half way\n"), std::string::npos) << "a killed run must leave its messages";
  EXPECT_TRUE(formats::ReadWholeFile(log).ends_with("\ndone\n"));
  EXPECT_EQ(RunWithFiles({"--log", log}, [](pipeline::StageRun&) { throw formats::DataError("bad row"); }), 1);
  EXPECT_TRUE(formats::ReadWholeFile(log).ends_with("\nfailed (1): bad row\n"));
}

TEST_F(StageTest, ListsItsOptionsForConfigure) {
  EXPECT_EQ(Run({"--list-options"}), 0);
  std::istringstream lines(out_);
  std::map<std::string, pipeline::OptionInfo> options;
  for (std::string line; std::getline(lines, line);) {
    const pipeline::OptionInfo option = pipeline::OptionFromLine(line);
    EXPECT_EQ(pipeline::ToLine(option), line);
    options[option.key] = option;
  }
  EXPECT_EQ(options.size(), 4U);
  EXPECT_EQ(options["length-m"], (pipeline::OptionInfo{"length-m", "number", "2", "0.5", "20", {}, "a length (m)"}));
  EXPECT_EQ(options["engine"].allowed, (std::vector<std::string>{"steam", "diesel"}));
  EXPECT_EQ(options["count"].max, "");
}

}  // namespace
