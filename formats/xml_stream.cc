// SPDX-License-Identifier: Apache-2.0
#include "formats/xml_stream.h"

#include <expat.h>

#include <exception>
#include <fstream>
#include <memory>

#include "formats/errors.h"
#include "formats/text_encoding.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::size_t kLongestText = std::size_t{1} << 28;
constexpr std::size_t kDeepest = 50;

std::string WithoutPrefix(const char* name) {
  const std::string text(name);
  const std::size_t colon = text.rfind(':');
  return colon == std::string::npos ? text : text.substr(colon + 1);
}

// The parser's call-backs must not throw: what goes wrong is kept and thrown when the parser has returned.
class Parser {
 public:
  Parser(const std::filesystem::path& file, const XmlHandlers& handlers, const char* encoding)
      : file_(file), handlers_(handlers), parser_(XML_ParserCreate(encoding), XML_ParserFree) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &Parser::OnStart, &Parser::OnEnd);
    XML_SetCharacterDataHandler(parser_.get(), &Parser::OnText);
    XML_SetEntityDeclHandler(parser_.get(), &Parser::OnEntity);
    XML_SetExternalEntityRefHandler(parser_.get(), &Parser::OnExternal);
    XML_SetUnknownEncodingHandler(parser_.get(), &Parser::OnEncoding, nullptr);
  }

  void Run() {
    std::ifstream in(file_, std::ios::binary);
    if (!in) throw DataError(file_.string() + ": cannot be read");
    std::vector<char> block(kBlock);
    bool last = false;
    while (!last) {
      in.read(block.data(), static_cast<std::streamsize>(block.size()));
      last = in.gcount() < static_cast<std::streamsize>(block.size());
      const XML_Status status = XML_Parse(parser_.get(), block.data(), static_cast<int>(in.gcount()), last ? 1 : 0);
      if (error_) std::rethrow_exception(error_);
      if (status == XML_STATUS_OK) continue;
      throw DataError(Where() + "is not well-formed XML: " + XML_ErrorString(XML_GetErrorCode(parser_.get())));
    }
  }

 private:
  std::string Where() const {
    return file_.string() + ":" + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": ";
  }

  template <typename Function>
  void Guarded(Function function) {
    if (error_) return;
    try {
      function();
    } catch (...) {
      error_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  static void OnStart(void* data, const char* name, const char** attributes) {
    auto& self = *static_cast<Parser*>(data);
    self.Guarded([&] {
      if (self.texts_.size() >= kDeepest) throw DataError(self.Where() + "elements are nested too deeply");
      self.texts_.emplace_back();
      XmlElement element(self.Where(), WithoutPrefix(name));
      for (; *attributes != nullptr; attributes += 2) {
        const std::string attribute = attributes[0];
        if (attribute == "xmlns" || attribute.starts_with("xmlns:") || attribute.starts_with("xsi:")) continue;
        element.Add(attribute, std::string(Trimmed(attributes[1])));
      }
      self.handlers_.start(element);
    });
  }

  static void OnEnd(void* data, const char* name) {
    auto& self = *static_cast<Parser*>(data);
    self.Guarded([&] {
      if (self.handlers_.end) self.handlers_.end(WithoutPrefix(name), self.texts_.back(), self.Where());
      self.texts_.pop_back();
    });
  }

  static void OnText(void* data, const char* text, int length) {
    auto& self = *static_cast<Parser*>(data);
    self.Guarded([&] {
      std::string& whole = self.texts_.back();
      whole.append(text, static_cast<std::size_t>(length));
      if (whole.size() > kLongestText) throw DataError(self.Where() + "holds a text of more than 256 MB");
    });
  }

  static void OnEntity(void* data, const char* name, int /*is_parameter*/, const char* /*value*/, int /*length*/,
                       const char* /*base*/, const char* /*system*/, const char* /*public_id*/,
                       const char* /*notation*/) {
    auto& self = *static_cast<Parser*>(data);
    self.Guarded([&] {
      throw DataError(self.Where() + "declares the entity \"" + name + "\": entity declarations are refused");
    });
  }

  static int OnExternal(XML_Parser parser, const char* /*context*/, const char* /*base*/, const char* /*system*/,
                        const char* /*public_id*/) {
    auto& self = *static_cast<Parser*>(XML_GetUserData(parser));
    self.Guarded([&] { throw DataError(self.Where() + "refers to an external entity: refused"); });
    return XML_STATUS_ERROR;
  }

  // Eight-bit encodings that are not known pass through as Latin-1, which leaves digits and names in ASCII right.
  static int OnEncoding(void* /*data*/, const char* /*name*/, XML_Encoding* info) {
    for (int byte = 0; byte < 256; ++byte) info->map[byte] = byte;
    info->data = nullptr;
    info->convert = nullptr;
    info->release = nullptr;
    return XML_STATUS_OK;
  }

  const std::filesystem::path& file_;
  const XmlHandlers& handlers_;
  std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser_;
  std::vector<std::string> texts_;  // of the open elements
  std::exception_ptr error_;
};

// The encoding that the XML declaration names, in lower case; empty when it names none.
std::string DeclaredEncoding(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string start(200, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF")) return "utf-16";
  const std::size_t declaration = start.find("<?xml"), end = start.find("?>");
  const std::size_t at = start.find("encoding", declaration);
  if (declaration == std::string::npos || at == std::string::npos || at > end) return "";
  const std::size_t open = start.find_first_of("\"'", at), close = start.find_first_of("\"'", open + 1);
  if (open == std::string::npos || close == std::string::npos) return "";
  std::string name = start.substr(open + 1, close - open - 1);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

}  // namespace

std::string XmlElement::Text(const std::string& attribute) {
  known_[attribute] = true;
  const auto found = attributes_.find(attribute);
  return found == attributes_.end() ? "" : found->second;
}

std::string XmlElement::NeededText(const std::string& attribute) {
  std::string text = Text(attribute);
  if (text.empty()) Fail("attribute " + attribute + " is missing");
  return text;
}

double XmlElement::Number(const std::string& attribute, double default_value) {
  const std::string text = Text(attribute);
  if (!Has(attribute)) return default_value;
  const std::optional<double> value = ParseNumber(text);
  if (!value) Fail(attribute + " = \"" + text + "\": " + WhyNotANumber(text));
  return *value;
}

double XmlElement::NeededNumber(const std::string& attribute) {
  NeededText(attribute);
  return Number(attribute, 0.0);
}

int XmlElement::NeededCount(const std::string& attribute) {
  const double value = NeededNumber(attribute);
  if (!(value >= 0.0 && value <= 1e6 && value == static_cast<int>(value))) {
    Fail(attribute + " = " + NumberText(value) + ": must be a whole number from 0 to a million");
  }
  return static_cast<int>(value);
}

void XmlElement::RefuseOthers() const {
  for (const auto& [attribute, value] : attributes_) {
    if (!known_.contains(attribute)) Fail("unknown attribute " + attribute);
  }
}

void XmlElement::Fail(const std::string& what) const { throw DataError(where_ + "<" + name_ + ">: " + what); }

void ReadXml(const std::filesystem::path& file, const XmlHandlers& handlers, std::vector<std::string>* warnings) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw DataError(file.string() + ": no such file");
  const std::string declared = DeclaredEncoding(file);
  const char* encoding = nullptr;
  if ((declared.empty() || declared == "utf-8") && !FileIsUtf8(file)) {
    encoding = "ISO-8859-1";
    warnings->push_back(file.string() + ": is not UTF-8; read as Latin-1");
  }
  Parser(file, handlers, encoding).Run();
}

std::vector<double> NumbersOf(std::string_view text, const std::string& where) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::vector<double> numbers;
  std::size_t begin = text.find_first_not_of(kBlank);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    const std::optional<double> value = ParseNumber(word);
    if (!value) throw DataError(where + "\"" + std::string(word) + "\": " + WhyNotANumber(word));
    numbers.push_back(*value);
    begin = text.find_first_not_of(kBlank, end);
  }
  return numbers;
}

}  // namespace formats
