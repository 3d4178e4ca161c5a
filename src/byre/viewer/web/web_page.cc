#include "byre/viewer/web/web_site.h"

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

WebResponse page_response() {
  return {200, "text/html; charset=utf-8", {byre_web_page_begin, byre_web_page_end}};
}

}  // namespace byre
