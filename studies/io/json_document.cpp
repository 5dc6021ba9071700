#include "studies/io/json_document.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "studies/io/atomic_file.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/wording.hpp"

namespace stickslip {

using nlohmann::json;

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Goes through a text token by token, counting lines and columns. It trusts the parser that the text is JSON as far
/// as it is asked to go.
class TokenCursor {
 public:
  using Position = std::pair<int, int>;
  explicit TokenCursor(std::string_view text) : text_(text) {
    if (text_.substr(0, byte_order_mark.size()) == byte_order_mark) offset_ = byte_order_mark.size();
  }

  /// Where the next token begins; commas and colons are none.
  Position next_start() {
    for (; offset_ < text_.size(); advance()) {
      const char c = text_[offset_];
      if (c == '/') {
        skip_comment();
        if (offset_ >= text_.size()) break;
      } else if (std::string_view(" \t\r\n,:").find(c) == std::string_view::npos) {
        break;
      }
    }
    return {line_, column_};
  }

  /// Moves behind the next token and returns where it begins.
  Position take() {
    const Position start = next_start();
    begin_ = offset_;
    if (offset_ >= text_.size()) return start;
    const char first = text_[offset_];
    advance();
    if (first == '"') {
      for (; offset_ < text_.size() && text_[offset_] != '"'; advance())
        if (text_[offset_] == '\\') advance();
      advance();
    } else if (std::string_view("{}[]").find(first) == std::string_view::npos) {
      while (offset_ < text_.size() && std::string_view(" \t\r\n,:{}[]/\"").find(text_[offset_]) == std::string::npos)
        advance();
    }
    return start;
  }

  /// Moves to the comma before the next token; false where there is none.
  bool go_to_comma() {
    for (; offset_ < text_.size() && text_[offset_] != ','; advance()) {
      if (text_[offset_] == '/')
        skip_comment();
      else if (std::string_view(" \t\r\n").find(text_[offset_]) == std::string_view::npos)
        return false;
    }
    return offset_ < text_.size();
  }
  Position position() const { return {line_, column_}; }

  std::size_t offset() const { return offset_; }

  /// The token that was taken last.
  std::string_view taken() const { return text_.substr(begin_, offset_ - begin_); }

  std::string_view rest() const { return text_.substr(std::min(offset_, text_.size())); }

  /// Moves to a character offset further on and returns its place.
  Position go_to(std::size_t offset) {
    while (offset_ < std::min(offset, text_.size())) advance();
    return {line_, column_};
  }

 private:
  void advance() {
    if (offset_ >= text_.size()) return;
    if (text_[offset_] == '\n') {
      ++line_;
      column_ = 0;
    }
    ++offset_;
    // the bytes of a character in UTF-8 after its first count as none
    if (offset_ >= text_.size() || (static_cast<unsigned char>(text_[offset_]) & 0xC0) != 0x80) ++column_;
  }

  /// Leaves the cursor on the last character of the comment.
  void skip_comment() {
    const bool block = text_.substr(offset_, 2) == "/*";
    const std::size_t end = block ? text_.find("*/", offset_ + 2) : text_.find('\n', offset_);
    go_to(end == std::string_view::npos ? text_.size() : end + (block ? 1 : 0));
  }

  std::string_view text_;
  std::size_t offset_ = 0, begin_ = 0;
  int line_ = 1, column_ = 1;
};

/// "0.5" of ".5", and "-0.5" of "-.5"; "" of what is no such number.
std::string with_zero_before_point(std::string_view word) {
  const std::string sign = word.starts_with('-') ? "-" : "";
  const std::string_view digits = word.substr(sign.size());
  const bool number = digits.size() > 1 && digits[0] == '.' && std::isdigit(static_cast<unsigned char>(digits[1]));
  return number ? sign + "0" + std::string(digits) : "";
}

/// Whether a token is a value, or begins one.
bool begins_value(std::string_view token) {
  return !token.empty() && (std::isalnum(static_cast<unsigned char>(token[0])) ||
                            std::string_view("\"{[-").find(token[0]) != std::string_view::npos);
}

}  // namespace

/// Listens to the parser and notes where keys and values begin.
class PositionReader : public json::json_sax_t {
 public:
  PositionReader(std::string_view text, std::string file, Diagnostics& diagnostics)
      : text_(text), cursor_(text), file_(std::move(file)), diagnostics_(diagnostics) {}

  JsonDocument::Positions& positions() { return positions_; }

  bool null() override { return scalar(); }
  bool boolean(bool) override { return scalar(); }
  bool number_integer(number_integer_t) override { return scalar(); }
  bool number_unsigned(number_unsigned_t) override { return scalar(); }
  bool number_float(number_float_t, const string_t&) override { return scalar(); }
  bool string(string_t&) override { return scalar(); }
  bool binary(binary_t&) override { return scalar(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    const auto position = cursor_.take();
    key_ = name;
    const std::string pointer = child_pointer(open_.back().pointer, name);
    const auto [first, is_new] = positions_.keys.emplace(pointer, position);
    if (!is_new)
      diagnostics_.error(
          {{file_, position.first, position.second},
           pointer,
           "the key " + in_quotes(name) + " is given twice, first in line " + std::to_string(first->second.first)});
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& fault) override {
    std::string message = fault.what();
    if (const auto start = message.find("] "); start != std::string::npos) message.erase(0, start + 2);
    // the text that the parser had read: it may be of a file that is none of the user's
    if (const auto quote = message.find("; last read: '"); quote != std::string::npos)
      message.erase(quote, message.rfind('\'') + 1 - quote);
    if (const auto column = message.find(", column "); column != std::string::npos)
      message.erase(0, message.find(": ", column) + 2);
    const auto has = [&](const char* part) { return message.find(part) != std::string::npos; };
    const std::size_t last = position > 0 ? position - 1 : 0;  // of the last character that was read
    const bool mark = last < text_.size() && std::string_view("{}[],:").find(text_[last]) != std::string_view::npos;

    TokenCursor token = cursor_, comma = cursor_;
    TokenCursor::Position at = token.next_start();
    std::string pointer;
    if (last < cursor_.offset() && !open_.empty()) {  // as in 0x3, whose 0 alone was taken for the value
      at = positions_.values.at(last_value_);
      pointer = last_value_;
      message =
          "is " + std::string(cursor_.taken()) + ", which is not JSON; must be a number, a text, true, false or null";
    } else if (has("number overflow")) {
      message = "is a number beyond the range of a double; must be less than 1.8e308 in size";
      pointer = next_pointer();
    } else if (const std::string word = leading_word(token.rest()); is_not_finite(word)) {
      message = "is " + word + "; must be a finite number";
      pointer = next_pointer();
    } else if (has("unexpected") && last < text_.size() && (text_[last] == '}' || text_[last] == ']') &&
               comma.go_to_comma()) {
      at = comma.position();
      message = std::string("is not JSON: a comma stands before the ") + text_[last] + " that ends the " +
                (text_[last] == '}' ? "object" : "list") + "; take the comma out";
    } else if (token.take();
               has("unexpected") && (has("expected '}'") || has("expected ']'")) && begins_value(token.taken())) {
      at = cursor_.position();
      message =
          "is not JSON: a comma is missing here, before the next " + std::string(has("expected '}'") ? "key" : "value");
    } else if (has("invalid") && !with_zero_before_point(token.taken()).empty()) {
      message = "is " + std::string(token.taken()) + ", which is not JSON; must be " +
                with_zero_before_point(token.taken()) + ", with a digit before the point";
      pointer = next_pointer();
    } else {
      if (has("unexpected end of input"))
        at = TokenCursor(cursor_).go_to(text_.size());
      else if ((has("unexpected") && mark) ||
               !(has("unexpected") || has("invalid literal") || has("missing closing quote")))
        at = TokenCursor(cursor_).go_to(last);
      message = "is not JSON: " + message;
    }
    diagnostics_.error({{file_, at.first, at.second}, pointer, message});
    return false;
  }

 private:
  struct Open {
    std::string pointer;
    bool array;
    int count = 0;
  };

  /// Pointer of the value that comes next.
  std::string next_pointer() const {
    if (open_.empty()) return "";
    const Open& in = open_.back();
    return child_pointer(in.pointer, in.array ? std::to_string(in.count) : key_);
  }

  std::string value_begins() {
    const std::string pointer = next_pointer();
    positions_.values[pointer] = cursor_.take();
    if (!open_.empty()) ++open_.back().count;
    return pointer;
  }
  bool scalar() {
    last_value_ = value_begins();
    return true;
  }
  bool open(bool array) {
    constexpr std::size_t deepest = 64;  // pointers grow with depth: a file of brackets alone would fill the memory
    open_.push_back({value_begins(), array});
    if (open_.size() <= deepest) return true;
    const auto& [line, column] = positions_.values.at(open_.back().pointer);
    diagnostics_.error({{file_, line, column}, "", "is nested deeper than 64 values"});
    return false;
  }
  bool close() {
    cursor_.take();
    open_.pop_back();
    return true;
  }

  static std::string leading_word(std::string_view text) {
    const std::size_t sign = !text.empty() && text[0] == '-' ? 1 : 0;
    std::size_t end = sign;
    while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end]))) ++end;
    return std::string(text.substr(0, end));
  }
  static bool is_not_finite(std::string word) {
    if (!word.empty() && word[0] == '-') word.erase(0, 1);
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return word == "nan" || word == "inf" || word == "infinity";
  }

  std::string_view text_;
  TokenCursor cursor_;
  std::string file_;
  JsonDocument::Positions positions_;
  Diagnostics& diagnostics_;
  std::vector<Open> open_;
  std::string key_, last_value_;  // name; pointer of the last value that is no object or array
};

// --- document ----------------------------------------------------------------------------------------------------

std::optional<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics) {
  JsonDocument document;
  document.file_ = file;
  const std::size_t faults = diagnostics.error_count();
  PositionReader reader(text, file, diagnostics);
  constexpr bool strict = true, with_comments = true, exceptions = false;
  if (!json::sax_parse(text, &reader, json::input_format_t::json, strict, with_comments)) return std::nullopt;
  document.positions_ = std::make_shared<const Positions>(std::move(reader.positions()));
  if (diagnostics.error_count() > faults) return std::nullopt;
  document.root_ = json::parse(text, nullptr, exceptions, with_comments);
  return document;
}

JsonDocument JsonDocument::of(json value, const std::string& source) {
  JsonDocument document;
  document.file_ = source;
  document.set("", std::move(value), {source});
  return document;
}

namespace {

/// Files beside a missing one whose names are near to its; "" where there is none.
std::string near_file(const std::filesystem::path& missing) {
  std::vector<std::string> names;
  std::error_code unreadable;
  const auto folder = missing.has_parent_path() ? missing.parent_path() : std::filesystem::path(".");
  for (std::filesystem::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable))
    if (entry->path().extension() == ".json" && entry->path().filename() != missing.filename())
      names.push_back(entry->path().filename());
  std::sort(names.begin(), names.end());
  const std::string near = suggestion(missing.filename().string(), names);
  return near.empty() ? "" : ";" + near;
}

/// What a file is in place of JSON; "" where a parser has to find out.
std::string is_no_json(std::string_view content) {
  if (content.find_first_not_of(" \t\r\n") == std::string_view::npos) return "is empty; must be a JSON object, {...}";
  const bool utf_16 = content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF");
  if (utf_16 || content.find('\0') != std::string_view::npos)
    return "is no text, or not in UTF-8; must be a JSON object, {...}, in UTF-8";
  return "";
}

}  // namespace

std::optional<JsonDocument> JsonDocument::read(const std::string& file, Diagnostics& diagnostics) {
  constexpr std::uintmax_t most = 32 << 20;  // the places of 16 million values, the most it can hold, take 3 GB
  std::string fault = unreadable(file, most);
  if (std::error_code none; !fault.empty() && !std::filesystem::exists(file, none)) fault += near_file(file);
  std::ifstream stream;
  std::ostringstream text;
  if (fault.empty()) {
    stream.open(file, std::ios::binary);
    // an empty file sets failbit on the left of <<, which is no fault of reading
    if (stream) text << stream.rdbuf();
    if (!stream || stream.bad()) fault = "cannot be read";
  }
  Place place{file};
  if (fault.empty()) {
    fault = is_no_json(text.str());
    if (fault.empty()) return parse(text.str(), file, diagnostics);
    place = {file, 1, 1};
  }
  diagnostics.error({place, "", fault});
  return std::nullopt;
}

namespace {

/// The pointer itself, then what is around it, up to "".
template <class Found>
void walk_up(std::string pointer, Found&& found) {
  while (!found(pointer) && !pointer.empty()) pointer.erase(pointer.rfind('/'));
}

}  // namespace

std::optional<Place> JsonDocument::origin(const std::string& pointer) const {
  std::optional<Place> place;
  walk_up(pointer, [&](const std::string& each) {
    const auto found = origins_.find(each);
    if (found == origins_.end()) return false;
    place = found->second;
    place->pointer += pointer.substr(each.size());
    return true;
  });
  return place;
}

Place JsonDocument::place(const std::string& pointer) const {
  if (const auto given = origin(pointer)) return *given;
  Place place{file_, 1, 1};
  walk_up(pointer, [&](const std::string& each) {
    const auto value = positions_->values.find(each);
    if (value != positions_->values.end()) place = {file_, value->second.first, value->second.second, pointer};
    return value != positions_->values.end();
  });
  return place;
}

Place JsonDocument::key_place(const std::string& pointer) const {
  const auto key = positions_->keys.find(pointer);
  if (key == positions_->keys.end() || origin(pointer)) return place(pointer);
  return {file_, key->second.first, key->second.second};
}

void JsonDocument::set(const std::string& pointer, json value, Place origin) {
  root_[json::json_pointer(pointer)] = std::move(value);
  auto replaced = [&](const auto& each) { return each.first == pointer || each.first.rfind(pointer + "/", 0) == 0; };
  std::erase_if(origins_, replaced);
  origins_[pointer] = std::move(origin);
}

void JsonDocument::remove(const std::string& pointer) {
  const json::json_pointer at(pointer);
  root_[at.parent_pointer()].erase(at.back());
}

void JsonDocument::override_value(const std::string& assignment, Diagnostics& diagnostics) {
  const Place origin{diagnostics.caller().set + assignment, 0, 0};
  if (!is_utf8(assignment)) return diagnostics.error({origin, "", "is not UTF-8"});
  const auto equals = assignment.find('=');
  auto fault = [&](const std::string& message) { diagnostics.error({origin, "", message}); };
  if (equals == std::string::npos) return fault("is not POINTER=VALUE, for example /contacts/sole/friction=0.4");
  const std::string pointer = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  const json* old = value_at(root_, pointer);
  if (!is_pointer(pointer)) {
    const json* named = value_at(root_, child_pointer("/parameters", pointer));
    const bool known = named && named->is_string();
    return fault(pointer_fault(root_, pointer) +
                 (known ? "; the parameter " + pointer + " is " + named->get<std::string>() : ""));
  }
  const json* parent = value_at(root_, pointer.substr(0, pointer.rfind('/')));
  const bool can_add = parent && parent->is_object();  // an optional key: whoever reads the object says if it is none
  if (!old && !can_add) return fault(pointer_fault(root_, pointer));
  if (old && old->is_object()) return fault(pointer + " names an object; must name a number, a text or an array");
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) {
    if (const std::string number = with_zero_before_point(text); !number.empty())
      return fault(in_quotes(text) + " is not a value of JSON; must be " + number + ", with a digit before the point");
    if (old && !old->is_string())
      return fault(in_quotes(text) + " is not a value of JSON; must be like " + shown(*old));
    value = text;
  } else if (Diagnostics of_value; !parse(text, "", of_value)) {  // a key is given twice
    return fault(of_value.errors().front().message);
  }
  set(pointer, std::move(value), origin);
}

std::string fingerprint(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(hash >> shift) & 15];
  return digits;
}

}  // namespace stickslip
