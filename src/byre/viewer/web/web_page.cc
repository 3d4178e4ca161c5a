#include "byre/viewer/web/web_page.h"

// The assembler embeds the file BYRE_WEB_PAGE.
__asm__(
    ".pushsection .rodata\n"
    ".global byre_web_page_begin\n"
    "byre_web_page_begin: .incbin \"" BYRE_WEB_PAGE
    "\"\n"
    ".global byre_web_page_end\n"
    "byre_web_page_end: .byte 0\n"
    ".popsection\n");

extern "C" const char byre_web_page_begin[];
extern "C" const char byre_web_page_end[];

namespace byre {

std::string_view web_page() {
  return {byre_web_page_begin, static_cast<std::size_t>(byre_web_page_end - byre_web_page_begin)};
}

}  // namespace byre
