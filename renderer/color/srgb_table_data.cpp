#include "renderer/color/srgb_table_data.h"

// TESSERA_SRGB_TABLE is the path of the file that the build computed.
asm(R"(
  .section .rodata
  .balign 64
  .type tessera_srgb_table, @object
  .globl tessera_srgb_table
  .hidden tessera_srgb_table
tessera_srgb_table:
  .incbin ")" TESSERA_SRGB_TABLE R"("
  .size tessera_srgb_table, . - tessera_srgb_table
  .text
)");

extern "C" const float tessera_srgb_table[];

namespace tessera {

const float* SrgbTable() {
  return tessera_srgb_table;
}

}  // namespace tessera
