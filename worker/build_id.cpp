#include "worker/build_id.h"

#include <elf.h>
#include <link.h>

#include <cstring>

namespace tessera {
namespace {

constexpr size_t AlignedTo4(size_t size) {
  return (size + 3) & ~size_t{3};
}

// The descriptor of the build-id note among `size` bytes of notes, or "" (elf(5)).
std::string FindBuildId(const char* notes, size_t size) {
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) header;
    std::memcpy(&header, notes, sizeof header);
    const size_t name_size = AlignedTo4(header.n_namesz);
    const size_t whole = sizeof header + name_size + AlignedTo4(header.n_descsz);
    if (whole > size) break;
    const char* name = notes + sizeof header;
    if (header.n_type == NT_GNU_BUILD_ID && header.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
      return std::string(name + name_size, header.n_descsz);
    }
    notes += whole;
    size -= whole;
  }
  return {};
}

// Called for each loaded object, the executable first, which ends the iteration.
int VisitObject(dl_phdr_info* info, size_t, void* result) {
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = info->dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader gives addresses as numbers.
    const char* notes = reinterpret_cast<const char*>(info->dlpi_addr + segment.p_vaddr);
    std::string id = FindBuildId(notes, segment.p_memsz);
    if (!id.empty()) {
      *static_cast<std::string*>(result) = std::move(id);
      break;
    }
  }
  return 1;
}

}  // namespace

std::string BuildId() {
  std::string id;
  ::dl_iterate_phdr(VisitObject, &id);
  return id;
}

}  // namespace tessera
