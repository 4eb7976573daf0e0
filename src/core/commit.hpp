#pragma once

namespace rabiline {

/// The commit that the program was built from, with "-dirty" behind it where files were changed.
const char* commit();

}  // namespace rabiline
