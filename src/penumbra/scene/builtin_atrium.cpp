#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

Scene make_atrium(const BuiltinParameters&) { return {}; }

}  // namespace penumbra
