/// JSON pointers (RFC 6901): made, followed, and what is wrong with one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace stickslip {

/// The pointer of a member or element: `/` in a key becomes `~1`, `~` becomes `~0` (RFC 6901).
std::string child_pointer(const std::string& parent, std::string_view key);
/// Whether a text is a pointer to a value within a document: it begins with /, and each ~ with 0 or 1 behind it.
bool is_pointer(const std::string& text);
/// The value of a pointer; null where there is none or the text is no pointer.
const nlohmann::json* value_at(const nlohmann::json& root, const std::string& pointer);
/// What a pointer misses: "" where it names a value, else what is wrong with it and the nearest that exists.
std::string pointer_fault(const nlohmann::json& root, const std::string& pointer);

}  // namespace stickslip
