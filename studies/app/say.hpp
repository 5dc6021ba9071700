/// Text for the terminal, in lines that it has room for. A stream that takes no more says so at the end (main.cpp),
/// when all files are written; fmt::print throws.
#pragma once

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "studies/io/printing.hpp"

namespace stickslip {

template <class... Values>
void say(std::ostream& out, fmt::format_string<Values...> text, Values&&... values) {
  constexpr std::size_t below = 4;  // indent of a row that goes on
  out << wrapped_rows(fmt::format(text, std::forward<Values>(values)...), below, terminal_width(out));
}

}  // namespace stickslip
