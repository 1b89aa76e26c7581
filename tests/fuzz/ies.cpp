#include "penumbra/io/ies_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  const PhotometricWeb web = parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "input.ies");
  (void)candela_at(web, 45, 123);
  (void)luminous_flux(web);
}
