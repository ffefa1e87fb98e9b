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

std::string BuildIdOf(const dl_phdr_info& object) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader gives addresses as numbers.
    const char* notes = reinterpret_cast<const char*>(object.dlpi_addr + segment.p_vaddr);
    if (std::string id = FindBuildId(notes, segment.p_memsz); !id.empty()) return id;
  }
  return {};
}

// Called for each loaded object, the executable first, which ends the iteration.
int VisitFirst(dl_phdr_info* info, size_t, void* result) {
  *static_cast<std::string*>(result) = BuildIdOf(*info);
  return 1;
}

// Ends the iteration at an object without a build id.
int VisitEach(dl_phdr_info* info, size_t, void* result) {
  auto& ids = *static_cast<std::string*>(result);
  const std::string id = BuildIdOf(*info);
  ids = id.empty() ? "" : ids + id;
  return id.empty() ? 1 : 0;
}

}  // namespace

std::string BuildId() {
  std::string id;
  ::dl_iterate_phdr(VisitFirst, &id);
  return id;
}

std::string LoadedBuildIds() {
  std::string ids;
  ::dl_iterate_phdr(VisitEach, &ids);
  return ids;
}

}  // namespace tessera
