#include "diffusion/deflation.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "diffusion/islands.h"

namespace alabaster {

Deflation::Deflation(gpu::Context& context, const gpu::Image& stencil, glm::ivec3 cells, int channels) {
  std::vector<Islands> found(channels);
  {
    const gpu::Buffer copy = gpu::host_copy(context, stencil);
    const std::size_t each = copy.bytes() / sizeof(float) / channels;
    const float* all = static_cast<const float*>(copy.mapped());
    tbb::parallel_for(0, channels, [&](int c) { found[c] = find_islands(cells, std::span(all + c * each, each)); });
  }
  std::vector<std::uint32_t> labels, entries;
  std::vector<IslandSpan> spans;
  for (int c = 0; c < channels; ++c) {
    noise_ = std::max(noise_, found[c].noise);
    rough_ = rough_ || found[c].rough;
    const auto before = static_cast<std::uint32_t>(entries.size()), first = static_cast<std::uint32_t>(spans.size());
    for (std::uint32_t label : found[c].labels) labels.push_back(label > 0 ? first + label : 0);
    for (IslandSpan span : found[c].spans)
      spans.push_back({span.cells + before, span.faces + before, span.end + before, c, span.weight});
    entries.insert(entries.end(), found[c].entries.begin(), found[c].entries.end());
  }
  count_ = static_cast<int>(spans.size());
  if (count_ == 0) labels.assign(4, 0);
  labels_ = gpu::make_buffer(context, labels, "diffusion island labels");
  lifts_ = gpu::make_buffer(context, std::vector<float>(count_ + 1), "diffusion island lifts");
  if (count_ == 0) return;
  spans_ = gpu::make_buffer(context, spans, "diffusion islands");
  entries_ = gpu::make_buffer(context, entries, "diffusion island entries");
}

}  // namespace alabaster
