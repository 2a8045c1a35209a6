// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage.h"

#include <signal.h>
#include <tbb/global_control.h>
#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>

#include "pipeline/nearest.h"
#include "pipeline/site_lock.h"
#include "pipeline/stage_program.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;
using formats::UsageError;

// Shortest text that reads back to the same number.
std::string ToText(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string Today() {
  const std::time_t now = std::time(nullptr);
  char buffer[64];
  std::tm local{};
  localtime_r(&now, &local);
  std::strftime(buffer, sizeof buffer, "%Y-%m-%d %H:%M:%S %z", &local);
  return buffer;
}

}  // namespace

struct Stage::Impl {
  struct Key {
    OptionInfo info;                                                       // for --list-options
    std::function<void(const toml::node&, const std::string&)> from_toml;  // throws UsageError
    std::function<std::string()> text;
    std::function<void()> check;
    CLI::Option* cli = nullptr;
  };
  struct Output {
    std::string name;
    fs::path* path;
  };

  std::string name;
  std::string example;
  CLI::App app;
  std::map<std::string, Key> keys;
  std::vector<std::function<void(StageRun&)>> declare_inputs;  // after parsing: existence check and role
  std::vector<Output> outputs;
  fs::path config;
  fs::path log;
  int threads = 0;
  bool quiet = false;
  bool list_options = false;
  // CLI11 wants somewhere to keep the NAME=FILE texts until they are split.
  std::vector<std::unique_ptr<std::vector<std::string>>> named_texts;

  void AddKey(const std::string& key_name, Key key) { keys.emplace(key_name, std::move(key)); }

  void DeclareFile(StageRun& run, const std::string& role, const fs::path& file, Content content) const {
    std::error_code error;
    if (fs::is_directory(file, error))
      throw DataError(file.string() + ": is a folder, expected the file for --" + role);
    if (!fs::exists(file, error)) throw DataError(file.string() + ": no such file (--" + role + ")");
    run.declared_.push_back({role, file, content});
  }

  void ReadConfig() {
    if (config.empty()) return;
    toml::table table;
    try {
      table = toml::parse_file(config.string());
    } catch (const toml::parse_error& error) {
      std::ostringstream where;
      where << config.string() << ":" << error.source().begin.line << ": " << error.description();
      throw UsageError(where.str());
    }
    for (const auto& [toml_key, node] : table) {
      const std::string key_name(toml_key.str());
      const std::string where = config.string() + ":" + std::to_string(node.source().begin.line) + ": " + key_name;
      const auto found = keys.find(key_name);
      if (found == keys.end()) throw UsageError(where + ": unknown key" + Suggestion(key_name, KeyNames()));
      if (found->second.cli->count() == 0) found->second.from_toml(node, where);
    }
  }

  std::vector<std::string> KeyNames() const {
    std::vector<std::string> names;
    for (const auto& [key_name, key] : keys) names.push_back(key_name);
    return names;
  }

  int ListOptions() const {
    for (const auto& [key_name, key] : keys) {
      OptionInfo info = key.info;
      info.default_text = key.text();
      std::cout << ToLine(info) << "\n";
    }
    return 0;
  }

  // Everything cheap is checked before the body runs.
  void Prepare(StageRun& run) {
    ReadConfig();
    for (const auto& [key_name, key] : keys) {
      key.check();
      run.options_[key_name] = key.text();
    }
    run.quiet_ = quiet;
    for (const Output& output : outputs) {
      if (output.path->empty()) throw UsageError("--" + output.name + " is required");
    }
    for (const auto& declare : declare_inputs) declare(run);
  }

  // The log grows while the stage runs; its last line tells the outcome, so a killed run is seen by its absence.
  std::unique_ptr<std::ostream> OpenLog(const std::string& command) const {
    if (log.empty()) return nullptr;
    std::error_code error;
    if (log.has_parent_path()) fs::create_directories(log.parent_path(), error);
    auto file = std::make_unique<std::ofstream>(log);
    *file << "command: " << command << "\nversion: " << Version() << "\nhost: " << HostName() << "\nbegan: " << Today()
          << std::endl;
    return file;
  }
};

Stage::Stage(std::string name, std::string description, std::string example) : impl_(std::make_unique<Impl>()) {
  impl_->name = std::move(name);
  impl_->example = std::move(example);
  impl_->app.description(std::move(description));
  impl_->app.name("plumbline-" + impl_->name);
  impl_->app.footer("Example:\n  " + impl_->example);
  impl_->app.set_version_flag("--version", "plumbline-" + impl_->name + " " + Version());
  impl_->app.add_option("--config", impl_->config, "TOML file with values for the options below");
  impl_->app.add_option("--log", impl_->log, "where to write the log of this run");
  impl_->app.add_option("--threads", impl_->threads, "threads to use (0: all cores); never changes the result")
      ->check(CLI::Range(0, 1024));
  impl_->app.add_flag("--quiet", impl_->quiet, "no messages but warnings and errors");
  impl_->app
      .add_flag("--list-options", impl_->list_options, "print the configuration keys with their types and defaults")
      ->group("");
  impl_->app.get_formatter()->column_width(34);
}

Stage::~Stage() = default;

void Stage::Input(const std::string& name, fs::path* file, const std::string& help, Content content) {
  impl_->app.add_option("--" + name, *file, help)->type_name("FILE")->group("Inputs");
  impl_->declare_inputs.push_back([this, name, file, content](StageRun& run) {
    if (file->empty()) throw UsageError("--" + name + " is required");
    impl_->DeclareFile(run, name, *file, content);
  });
}

void Stage::OptionalInput(const std::string& name, fs::path* file, const std::string& help, Content content) {
  impl_->app.add_option("--" + name, *file, help)->type_name("FILE")->group("Inputs");
  impl_->declare_inputs.push_back([this, name, file, content](StageRun& run) {
    if (!file->empty()) impl_->DeclareFile(run, name, *file, content);
  });
}

void Stage::Inputs(const std::string& name, std::vector<fs::path>* files, const std::string& help, bool required,
                   Content content) {
  impl_->app.add_option("--" + name, *files, help)->type_name("FILE ...")->group("Inputs");
  impl_->declare_inputs.push_back([this, name, files, required, content](StageRun& run) {
    if (files->empty() && required) throw UsageError("--" + name + " is required");
    for (const fs::path& file : *files) impl_->DeclareFile(run, name + " " + file.filename().string(), file, content);
  });
}

void Stage::NamedInputs(const std::string& name, std::vector<NamedFile>* files, const std::string& help, bool required,
                        Content content) {
  impl_->named_texts.push_back(std::make_unique<std::vector<std::string>>());
  std::vector<std::string>* texts = impl_->named_texts.back().get();
  impl_->app.add_option("--" + name, *texts, help)->type_name("NAME=FILE ...")->group("Inputs");
  impl_->declare_inputs.push_back([this, name, files, texts, required, content](StageRun& run) {
    if (texts->empty() && required) throw UsageError("--" + name + " is required");
    for (const std::string& text : *texts) {
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
        throw UsageError("--" + name + " " + text + ": expected NAME=FILE");
      }
      files->push_back({text.substr(0, equals), text.substr(equals + 1)});
      impl_->DeclareFile(run, name + " " + files->back().name, files->back().file, content);
    }
  });
}

void Stage::Output(const std::string& name, fs::path* path, const std::string& help) {
  impl_->app.add_option("--" + name, *path, help)->type_name("PATH")->group("Outputs");
  impl_->outputs.push_back({name, path});
}

void Stage::OptionalOutput(const std::string& name, fs::path* path, const std::string& help) {
  impl_->app.add_option("--" + name, *path, help)->type_name("PATH")->group("Outputs");
}

namespace {

void CheckRange(const std::string& name, double value, const Range& range) {
  if (value >= range.min && value <= range.max) return;
  std::string rule;
  if (range.max == std::numeric_limits<double>::max()) {
    rule = "at least " + ToText(range.min);
  } else if (range.min == std::numeric_limits<double>::lowest()) {
    rule = "at most " + ToText(range.max);
  } else {
    rule = "between " + ToText(range.min) + " and " + ToText(range.max);
  }
  throw UsageError(name + " = " + ToText(value) + ": must be " + rule);
}

OptionInfo Describe(const std::string& name, const std::string& type, const std::string& help, const Range& range = {},
                    const std::vector<std::string>& allowed = {}) {
  const Range unbounded;
  return {.key = name,
          .type = type,
          .default_text = "",
          .min = range.min == unbounded.min ? "" : ToText(range.min),
          .max = range.max == unbounded.max ? "" : ToText(range.max),
          .allowed = allowed,
          .help = help};
}

template <typename T>
std::function<void(const toml::node&, const std::string&)> NumberFromToml(T* value, const std::string& type) {
  return [value, type](const toml::node& node, const std::string& where) {
    const auto number = [&]() -> std::optional<T> {
      if constexpr (std::is_floating_point_v<T>) {
        return node.is_number() ? node.value<T>() : std::nullopt;
      } else {
        return node.is_integer() ? node.value<T>() : std::nullopt;
      }
    }();
    if (!number) throw UsageError(where + ": expected " + type);
    *value = *number;
  };
}

}  // namespace

void Stage::Option(const std::string& name, double* value, const std::string& help, Range range) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)->capture_default_str()->group("Options");
  impl_->AddKey(name, {Describe(name, "number", help, range), NumberFromToml(value, "a number"),
                       [value] { return ToText(*value); },
                       [=] {
                         if (!std::isfinite(*value)) throw UsageError(name + ": must be a finite number");
                         CheckRange(name, *value, range);
                       },
                       cli});
}

void Stage::Option(const std::string& name, std::optional<double>* value, const std::string& help, Range range) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)->type_name("FLOAT")->group("Options");
  impl_->AddKey(name, {Describe(name, "number", help, range),
                       [value](const toml::node& node, const std::string& where) {
                         value->emplace();
                         NumberFromToml(&**value, "a number")(node, where);
                       },
                       [value] { return *value ? ToText(**value) : ""; },
                       [=] {
                         if (!*value) return;
                         if (!std::isfinite(**value)) throw UsageError(name + ": must be a finite number");
                         CheckRange(name, **value, range);
                       },
                       cli});
}

void Stage::Option(const std::string& name, int* value, const std::string& help, Range range) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)->capture_default_str()->group("Options");
  impl_->AddKey(name, {Describe(name, "integer", help, range), NumberFromToml(value, "an integer"),
                       [value] { return std::to_string(*value); }, [=] { CheckRange(name, *value, range); }, cli});
}

void Stage::Option(const std::string& name, std::int64_t* value, const std::string& help, Range range) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)->capture_default_str()->group("Options");
  impl_->AddKey(name, {Describe(name, "integer", help, range), NumberFromToml(value, "an integer"),
                       [value] { return std::to_string(*value); },
                       [=] { CheckRange(name, static_cast<double>(*value), range); }, cli});
}

void Stage::Option(const std::string& name, bool* value, const std::string& help) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)
                         ->capture_default_str()
                         ->type_name("true|false")
                         ->group("Options");
  impl_->AddKey(name, {Describe(name, "boolean", help),
                       [value](const toml::node& node, const std::string& where) {
                         if (!node.is_boolean()) throw UsageError(where + ": expected true or false");
                         *value = *node.value<bool>();
                       },
                       [value] { return *value ? "true" : "false"; }, [] {}, cli});
}

void Stage::Option(const std::string& name, std::string* value, const std::string& help,
                   const std::vector<std::string>& allowed) {
  CLI::Option* cli = impl_->app.add_option("--" + name, *value, help)->capture_default_str()->group("Options");
  impl_->AddKey(name, {Describe(name, "string", help, {}, allowed),
                       [value](const toml::node& node, const std::string& where) {
                         if (!node.is_string()) throw UsageError(where + ": expected a text in quotes");
                         *value = *node.value<std::string>();
                       },
                       [value] { return *value; },
                       [=] {
                         if (allowed.empty() || std::find(allowed.begin(), allowed.end(), *value) != allowed.end())
                           return;
                         throw UsageError(name + " = \"" + *value + "\": must be one of " + Joined(allowed));
                       },
                       cli});
}

void Stage::Flag(const std::string& name, bool* value, const std::string& help) {
  impl_->app.add_flag("--" + name, *value, help)->group("Options");
}

void Stage::Text(const std::string& name, std::string* value, const std::string& help,
                 const std::vector<std::string>& allowed) {
  CLI::Option* option = impl_->app.add_option("--" + name, *value, help)->group("Options");
  if (!allowed.empty()) option->check(CLI::IsMember(allowed));
}

void Stage::Positional(const std::string& name, fs::path* file, const std::string& help) {
  impl_->app.add_option(name, *file, help)->group("Inputs");
  impl_->declare_inputs.push_back([name, file](StageRun&) {
    if (file->empty()) throw UsageError(name + " is required");
  });
}

int Stage::Run(int argc, char** argv, const std::function<void(StageRun&)>& body) {
  // A reader that went away (a closed terminal, a pager) must not end a stage that writes artefacts.
  if (!impl_->outputs.empty()) signal(SIGPIPE, SIG_IGN);
  StageRun run;
  run.stage_ = impl_->name;
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&](int status, const std::string& message) {
    if (!message.empty()) std::cerr << "plumbline-" << impl_->name << ": " << message << std::endl;
    if (run.log_) {
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      *run.log_ << "seconds: " << seconds << "\n"
                << (message.empty() ? "done" : "failed (" + std::to_string(status) + "): " + message) << std::endl;
    }
    return status;
  };
  try {
    impl_->app.parse(argc, argv);
    if (impl_->list_options) return impl_->ListOptions();
    std::string command = argv[0];
    for (int i = 1; i < argc; ++i) command += " " + std::string(argv[i]);
    run.log_ = impl_->OpenLog(command);
    impl_->Prepare(run);
    std::optional<tbb::global_control> limit;
    if (impl_->threads > 0)
      limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(impl_->threads));
    run.threads_ = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    if (run.log_) *run.log_ << "threads: " << run.threads_ << std::endl;
    body(run);
    std::cout.flush();
    if (!std::cout) throw DataError("standard output: could not be written");
    return finish(0, "");
  } catch (const CLI::Success& success) {
    return impl_->app.exit(success);
  } catch (const CLI::ParseError& error) {
    return finish(2, std::string(error.what()) + " (see --help)");
  } catch (const UsageError& error) {
    return finish(2, error.what());
  } catch (const DataError& error) {
    return finish(1, error.what());
  } catch (const fs::filesystem_error& error) {
    return finish(1, error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    return finish(1, "out of memory: this machine has too little for the input");
  } catch (const std::exception& error) {
    return finish(
        3, std::string("internal error: ") + error.what() + "; please report it with the command above and the inputs");
  }
}

}  // namespace pipeline
