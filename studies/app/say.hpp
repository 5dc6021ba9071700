/// Text for the terminal. A stream that takes no more says so at the end (main.cpp), when all files are written;
/// fmt::print throws.
#pragma once

#include <fmt/format.h>

#include <ostream>
#include <utility>

namespace stickslip {

template <class... Values>
void say(std::ostream& out, fmt::format_string<Values...> text, Values&&... values) {
  out << fmt::format(text, std::forward<Values>(values)...);
}

}  // namespace stickslip
