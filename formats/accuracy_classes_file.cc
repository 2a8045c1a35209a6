// SPDX-License-Identifier: Apache-2.0
#include "formats/accuracy_classes_file.h"

#include <string_view>

#include "formats/accuracy_classes_text.h"
#include "formats/toml_section.h"

namespace formats {
namespace {

using survey::AccuracyClass;
using survey::ClassStatistic;

constexpr ClassStatistic kStatistics[] = {ClassStatistic::kRmseHorizontal, ClassStatistic::kRmseAxis,
                                          ClassStatistic::kCircle95, ClassStatistic::kNssda95};
constexpr double kLargestLimit = 1000.0;

void ReadStatistic(TomlSection* section, AccuracyClass* result) {
  std::vector<std::string> words;
  for (const ClassStatistic statistic : kStatistics) words.emplace_back(survey::Name(statistic));
  std::string word = section->RequiredText("statistic");
  section->Word("statistic", &word, words);
  for (const ClassStatistic statistic : kStatistics) {
    if (survey::Name(statistic) == word) result->statistic = statistic;
  }
}

// False when the class is a multiple of one that was not asked for.
bool ReadLimit(TomlSection* section, std::optional<double> class_m, AccuracyClass* result) {
  const bool times = section->Has("times_class");
  if (times == section->Has("limit_m")) section->Fail("needs either limit_m or times_class");
  section->Number("limit_m", &result->limit_m, {.min = 1e-6, .max = kLargestLimit});
  double factor = 1.0;
  section->Number("times_class", &factor, {.min = 1e-3, .max = 1e3});
  if (times) result->limit_m = factor * class_m.value_or(0.0);
  return !times || class_m.has_value();
}

std::vector<AccuracyClass> Parse(const toml::table& table, const std::filesystem::path& file,
                                 std::optional<double> class_m) {
  TomlSection document(table, file, "file");
  std::vector<AccuracyClass> classes;
  for (TomlSection& section : document.Tables("class")) {
    AccuracyClass each;
    each.standard = section.RequiredText("standard");
    each.name = section.RequiredText("name");
    section.Text("source", &each.source);
    ReadStatistic(&section, &each);
    each.confidence = 0.95;
    section.Number("confidence", &each.confidence, {.min = 0.01, .max = 0.9999});
    const bool known = ReadLimit(&section, class_m, &each);
    section.Finish();
    if (known) classes.push_back(each);
  }
  document.Finish();
  return classes;
}

}  // namespace

std::vector<AccuracyClass> StandardAccuracyClasses(std::optional<double> class_m) {
  return Parse(toml::parse(std::string_view(kAccuracyClassesText)), "accuracy_classes.toml", class_m);
}

std::vector<AccuracyClass> ReadAccuracyClasses(const std::filesystem::path& file, std::optional<double> class_m) {
  return Parse(ParseTomlFile(file), file, class_m);
}

}  // namespace formats
