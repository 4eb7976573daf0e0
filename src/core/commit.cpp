#include "core/commit.hpp"

#include "core/commit_of_source.hpp"

namespace rabiline {

const char* commit() { return commit_of_source; }

}  // namespace rabiline
