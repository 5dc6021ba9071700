#include "studies/json_document.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace stickslip {

using nlohmann::json;

// --- faults ------------------------------------------------------------------------------------------------------

std::string Diagnostic::text() const {
  std::string text = place.source;
  if (place.line > 0) text += ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
  if (!text.empty()) text += ": ";
  if (!pointer.empty()) text += pointer + ": ";
  return text + message;
}

void Diagnostics::error(Diagnostic diagnostic) {
  const std::string text = diagnostic.text();
  if (std::any_of(errors_.begin(), errors_.end(), [&](const auto& each) { return each.text() == text; })) return;
  errors_.push_back(std::move(diagnostic));
}
void Diagnostics::note(Diagnostic diagnostic) { notes_.push_back(std::move(diagnostic)); }

bool Diagnostics::has_error_in(const std::string& pointer) const {
  return std::any_of(errors_.begin(), errors_.end(), [&](const Diagnostic& each) {
    return each.pointer == pointer || each.pointer.rfind(pointer + "/", 0) == 0;
  });
}

std::vector<Diagnostic> Diagnostics::errors() const {
  std::map<std::string, std::size_t> met;
  for (const auto& each : errors_) met.emplace(each.place.source, met.size());
  std::vector<Diagnostic> sorted = errors_;
  auto rank = [&](const Diagnostic& each) {
    return std::make_tuple(met.at(each.place.source), each.place.line, each.place.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return sorted;
}

std::string Diagnostics::text() const {
  std::string text;
  for (const auto& each : errors()) text += each.text() + "\n";
  return text;
}

// --- positions ---------------------------------------------------------------------------------------------------

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
  std::size_t offset_ = 0;
  int line_ = 1, column_ = 1;
};

}  // namespace

/// Listens to the parser and notes where keys and values begin.
class PositionReader : public json::json_sax_t {
 public:
  PositionReader(std::string_view text, JsonDocument& document, Diagnostics& diagnostics)
      : text_(text), cursor_(text), document_(document), diagnostics_(diagnostics) {}

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
    const auto [first, is_new] = document_.keys_.emplace(pointer, position);
    if (!is_new)
      diagnostics_.error(
          {{document_.file_, position.first, position.second},
           pointer,
           "the key " + in_quotes(name) + " is given twice, first in line " + std::to_string(first->second.first)});
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& fault) override {
    std::string message = fault.what();
    if (const auto start = message.find("] "); start != std::string::npos) message.erase(0, start + 2);
    if (const auto column = message.find(", column "); column != std::string::npos)
      message.erase(0, message.find(": ", column) + 2);
    const auto has = [&](const char* part) { return message.find(part) != std::string::npos; };
    const std::size_t last = position > 0 ? position - 1 : 0;  // of the last character that was read
    const bool mark = last < text_.size() && std::string_view("{}[],:").find(text_[last]) != std::string_view::npos;

    TokenCursor token = cursor_;
    TokenCursor::Position at = token.next_start();
    std::string pointer;
    if (has("number overflow")) {
      message = "is a number beyond the range of a double; must be less than 1.8e308 in size";
      pointer = next_pointer();
    } else if (const std::string word = leading_word(token.rest()); is_not_finite(word)) {
      message = "is " + word + "; must be a finite number";
      pointer = next_pointer();
    } else {
      if (has("unexpected end of input"))
        at = TokenCursor(cursor_).go_to(text_.size());
      else if ((has("unexpected") && mark) ||
               !(has("unexpected") || has("invalid literal") || has("missing closing quote")))
        at = TokenCursor(cursor_).go_to(last);
      message = "is not JSON: " + message;
    }
    diagnostics_.error({{document_.file_, at.first, at.second}, pointer, message});
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
    document_.values_[pointer] = cursor_.take();
    if (!open_.empty()) ++open_.back().count;
    return pointer;
  }
  bool scalar() {
    value_begins();
    return true;
  }
  bool open(bool array) {
    constexpr std::size_t deepest = 64;  // pointers grow with depth: a file of brackets alone would fill the memory
    open_.push_back({value_begins(), array});
    if (open_.size() <= deepest) return true;
    diagnostics_.error({document_.place(open_.back().pointer), "", "is nested deeper than 64 values"});
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
  JsonDocument& document_;
  Diagnostics& diagnostics_;
  std::vector<Open> open_;
  std::string key_;
};

// --- document ----------------------------------------------------------------------------------------------------

std::optional<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics) {
  JsonDocument document;
  document.file_ = file;
  const std::size_t faults = diagnostics.error_count();
  PositionReader reader(text, document, diagnostics);
  constexpr bool strict = true, with_comments = true, exceptions = false;
  if (!json::sax_parse(text, &reader, json::input_format_t::json, strict, with_comments)) return std::nullopt;
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

std::optional<JsonDocument> JsonDocument::read(const std::string& file, Diagnostics& diagnostics) {
  if (std::error_code none; std::filesystem::is_directory(file, none)) {
    diagnostics.error({{file}, "", "is a directory; must be a file"});
    return std::nullopt;
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  // an empty file sets failbit on the left of <<, which is no fault of reading
  if (stream) text << stream.rdbuf();
  if (!stream || stream.bad()) {
    diagnostics.error({{file}, "", "cannot be read"});
    return std::nullopt;
  }
  return parse(text.str(), file, diagnostics);
}

namespace {

/// The pointer itself, then what is around it, up to "".
template <class Found>
void walk_up(std::string pointer, Found&& found) {
  while (!found(pointer) && !pointer.empty()) pointer.erase(pointer.rfind('/'));
}

}  // namespace

Place JsonDocument::place(const std::string& pointer) const {
  Place place{file_, 1, 1};
  walk_up(pointer, [&](const std::string& each) {
    if (const auto origin = origins_.find(each); origin != origins_.end()) {
      place = origin->second;
      place.pointer += pointer.substr(each.size());
      return true;
    }
    const auto value = values_.find(each);
    if (value != values_.end()) place = {file_, value->second.first, value->second.second, pointer};
    return value != values_.end();
  });
  return place;
}

Place JsonDocument::key_place(const std::string& pointer) const {
  const auto key = keys_.find(pointer);
  return key == keys_.end() ? place(pointer) : Place{file_, key->second.first, key->second.second};
}

void JsonDocument::set(const std::string& pointer, json value, Place origin) {
  root_[json::json_pointer(pointer)] = std::move(value);
  auto replaced = [&](const auto& each) { return each.first == pointer || each.first.rfind(pointer + "/", 0) == 0; };
  std::erase_if(values_, replaced);
  std::erase_if(keys_, replaced);
  std::erase_if(origins_, replaced);
  origins_[pointer] = std::move(origin);
}

void JsonDocument::remove(const std::string& pointer) {
  const json::json_pointer at(pointer);
  root_[at.parent_pointer()].erase(at.back());
}

void JsonDocument::override_value(const std::string& assignment, Diagnostics& diagnostics) {
  const Place origin{"--set " + assignment, 0, 0};
  const auto equals = assignment.find('=');
  auto fault = [&](const std::string& message) { diagnostics.error({origin, "", message}); };
  if (equals == std::string::npos) return fault("is not POINTER=VALUE, for example /contacts/sole/friction=0.4");
  const std::string pointer = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  const json* old = value_at(root_, pointer);
  const json* parent = pointer.empty() ? nullptr : value_at(root_, pointer.substr(0, pointer.rfind('/')));
  const bool can_add = parent && parent->is_object();  // an optional key: whoever reads the object says if it is none
  if (const std::string message = pointer_fault(root_, pointer); !old && !can_add) return fault(message);
  if (old && old->is_object()) return fault(pointer + " names an object; must name a number, a text or an array");
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) {
    if (old && !old->is_string())
      return fault(in_quotes(text) + " is not a value of JSON; must be like " + shown(*old));
    value = text;
  }
  set(pointer, std::move(value), origin);
}

// --- pointers ----------------------------------------------------------------------------------------------------

std::string child_pointer(const std::string& parent, std::string_view key) {
  std::string pointer = parent + "/";
  for (char c : key) {
    if (c == '~')
      pointer += "~0";
    else if (c == '/')
      pointer += "~1";
    else
      pointer += c;
  }
  return pointer;
}

namespace {

/// The keys of a pointer; none where it is no pointer.
std::optional<std::vector<std::string>> keys_of(const std::string& pointer) {
  std::vector<std::string> keys;
  if (!pointer.empty() && pointer[0] != '/') return std::nullopt;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      keys.emplace_back();
    } else if (pointer[i] == '~') {
      if (++i == pointer.size() || (pointer[i] != '0' && pointer[i] != '1')) return std::nullopt;
      keys.back() += pointer[i] == '0' ? '~' : '/';
    } else {
      keys.back() += pointer[i];
    }
  }
  return keys;
}

const json* member(const json& parent, const std::string& key) {
  if (parent.is_object()) {
    const auto found = parent.find(key);
    return found == parent.end() ? nullptr : &*found;
  }
  const bool index = !key.empty() && key.size() < 10 && key.find_first_not_of("0123456789") == std::string::npos &&
                     (key == "0" || key[0] != '0');
  if (!parent.is_array() || !index || std::stoul(key) >= parent.size()) return nullptr;
  return &parent[std::stoul(key)];
}

std::vector<std::string> names_in(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : object.items()) names.push_back(name);
  return names;
}

}  // namespace

const json* value_at(const json& root, const std::string& pointer) {
  const auto keys = keys_of(pointer);
  const json* value = keys ? &root : nullptr;
  for (std::size_t i = 0; value && i < keys->size(); ++i) value = member(*value, (*keys)[i]);
  return value;
}

std::string pointer_fault(const json& root, const std::string& pointer) {
  const auto keys = keys_of(pointer);
  if (!keys || keys->empty())
    return in_quotes(pointer) + " is no JSON pointer; must begin with / and name a value, such as /time/steps";
  const json* value = &root;
  std::string reached;
  for (const std::string& key : *keys) {
    const json* next = member(*value, key);
    if (!next) {
      std::string message = pointer + " names nothing: " + (reached.empty() ? "the file" : reached);
      if (value->is_array()) return message + " has elements 0 to " + std::to_string(value->size() - 1);
      if (!value->is_object()) return message + " is " + shown(*value) + " and holds no " + in_quotes(key);
      const auto names = names_in(*value);
      return message + " has no " + in_quotes(key) + ";" + suggestion(key, names) + " it has " + listed(names);
    }
    value = next;
    reached = child_pointer(reached, key);
  }
  return "";
}

// --- words -------------------------------------------------------------------------------------------------------

std::string shown(const json& value) {
  constexpr std::size_t room = 40;
  if (value.is_object() && value.size() > 2) return "an object of " + std::to_string(value.size()) + " keys";
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number == std::trunc(number) && std::abs(number) < 1e15) return std::to_string(static_cast<long long>(number));
  }
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() <= room) return text;
  std::size_t end = room;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not inside a character
  return text.substr(0, end) + "...";
}

std::string in_quotes(std::string_view name) { return "\"" + std::string(name) + "\""; }

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "nothing" : list;
}

namespace {

/// Letters put in, left out, replaced or swapped with their neighbour that turn one text into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& names) {
  constexpr std::size_t farthest = 2;
  std::size_t least = farthest + 1;
  std::string nearest;
  for (const std::string& candidate : names) {
    // a longer difference in length alone is too far, and keeps the table small
    if (std::max(name.size(), candidate.size()) > std::min(name.size(), candidate.size()) + farthest) continue;
    const std::size_t distance = edit_distance(name, candidate);
    // a name of two letters is within two edits of any other
    if (distance < least && distance < candidate.size()) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : " did you mean " + in_quotes(nearest) + "?";
}

std::string fingerprint(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(hash >> shift) & 15];
  return digits;
}

}  // namespace stickslip
