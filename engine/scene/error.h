#pragma once

#include <stdexcept>
#include <string>

namespace alabaster {

/// A failure the user can mend. what() is one line that names the file, the field and the remedy; apps print it and
/// exit 1.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace alabaster
