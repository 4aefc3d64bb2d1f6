// Several scenes on one picture, each render beside its reference, for people to look at.
#pragma once

#include <string>
#include <vector>

#include "image/picture.h"

namespace alabaster {

struct Shown {
  std::string caption;
  Picture picture;  // with R, G, B and, where the object is to set the exposure, object.Y
};

/// Pictures that stand side by side under one exposure, which the last, the reference, sets: the 99th percentile of its
/// object is shown as 0.9.
using GalleryRow = std::vector<Shown>;

/// `rows` in `columns` columns, a caption under each picture; 8-bit PNG where `path` ends so, else JPEG, a sixth as
/// large where the references are noisy; whole or not at all. Throws UserError where the pictures are not all of one
/// size or lack a channel.
void write_gallery(const std::vector<GalleryRow>& rows, int columns, const std::string& path);

}  // namespace alabaster
