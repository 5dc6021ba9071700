/// What the commands of the program return to the shell, as docs/commands.md says.
#pragma once

namespace stickslip {

inline constexpr int done = 0;        ///< all that was asked for is there
inline constexpr int our_bug = 1;     ///< an exception that none of the program's messages foresees
inline constexpr int bad_input = 2;   ///< a file or an option has a fault; or a disk is full
inline constexpr int not_solved = 3;  ///< written, but a run failed, cells of a study have no row, or a check fails

}  // namespace stickslip
