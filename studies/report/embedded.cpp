#include "studies/report/embedded.hpp"

// The assembler copies a file faster than a compiler reads an array of its bytes (0.05 s against 0.6 s for Vega).
// STICKSLIP_REPORT_DIR and STICKSLIP_VEGA_DIR come from CMakeLists.txt, which also lists the files as dependencies.
#if !defined(__ELF__)
#error "embedded.cpp uses ELF sections"
#endif

#define STICKSLIP_EMBED(name, path)                                                                     \
  __asm__(".pushsection .rodata\n.globl stickslip_embedded_" #name "\n.globl stickslip_embedded_" #name \
          "_end\nstickslip_embedded_" #name ":\n.incbin \"" path "\"\nstickslip_embedded_" #name        \
          "_end:\n.byte 0\n.popsection\n");                                                             \
  extern "C" const char stickslip_embedded_##name[];                                                    \
  extern "C" const char stickslip_embedded_##name##_end[];                                              \
  namespace stickslip::report::embedded {                                                               \
  std::string_view name() {                                                                             \
    return {stickslip_embedded_##name,                                                                  \
            static_cast<std::size_t>(stickslip_embedded_##name##_end - stickslip_embedded_##name)};     \
  }                                                                                                     \
  }

STICKSLIP_EMBED(page_html, STICKSLIP_REPORT_DIR "/page.html")
STICKSLIP_EMBED(page_css, STICKSLIP_REPORT_DIR "/page.css")
STICKSLIP_EMBED(numerals_js, STICKSLIP_REPORT_DIR "/numerals.js")
STICKSLIP_EMBED(page_js, STICKSLIP_REPORT_DIR "/page.js")
STICKSLIP_EMBED(vega_js, STICKSLIP_VEGA_DIR "/vega.min.js")
STICKSLIP_EMBED(vega_lite_js, STICKSLIP_VEGA_DIR "/vega-lite.min.js")
STICKSLIP_EMBED(vega_embed_js, STICKSLIP_VEGA_DIR "/vega-embed.min.js")
STICKSLIP_EMBED(third_party_notices, STICKSLIP_VEGA_DIR "/THIRD_PARTY_NOTICES")
