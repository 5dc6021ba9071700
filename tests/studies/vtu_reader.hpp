/// Reads back what studies/vtu writes, apart from it.
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::vtu {

/// Written apart from the encoder: a bit buffer over a table of digits.
inline std::vector<unsigned char> decode_base64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  if (text.size() % 4 != 0) throw std::runtime_error("base64 comes in groups of four");
  std::vector<unsigned char> bytes;
  unsigned buffer = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("not base64");
    buffer = buffer << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(buffer >> bits & 0xff));
    }
  }
  return bytes;
}

/// The DataArray of that name.
struct Array {
  std::string attributes;
  std::vector<unsigned char> payload;

  template <class T>
  std::vector<T> values() const {
    std::vector<T> out(payload.size() / sizeof(T));
    if (!payload.empty()) std::memcpy(out.data(), payload.data(), payload.size());
    return out;
  }
};

inline Array array_named(const std::string& xml, const std::string& name) {
  const std::size_t at = xml.find("Name=\"" + name + "\"");
  if (at == std::string::npos) throw std::runtime_error("no array " + name);
  const std::size_t begin = xml.rfind('<', at), open = xml.find('>', at), close = xml.find('<', open);
  const std::vector<unsigned char> bytes = decode_base64(xml.substr(open + 1, close - open - 1));
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  if (bytes.size() != sizeof size + size) throw std::runtime_error("the header of " + name + " tells another size");
  return {xml.substr(begin, open - begin), {bytes.begin() + sizeof size, bytes.end()}};
}

}  // namespace stickslip::vtu
