#pragma once

/// Puts a file's bytes into the program: `WAYFUSE_EMBED(page, "/abs/path/page.html")` declares `page` and `page_end`.
///
/// The assembler copies them: any size, any bytes, nothing generated. At namespace scope, once a name.
#define WAYFUSE_EMBED(name, file)                            \
  asm(".section .rodata\n"                                   \
      ".global " #name "\n.global " #name "_end\n"           \
      #name ":\n.incbin \"" file "\"\n"                      \
      #name "_end:\n.byte 0\n"                               \
      ".previous\n");                                        \
  extern "C" const char name[], name##_end[]
