#include "diffusion/deflation.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "diffusion/islands.h"

namespace alabaster {

Deflation::Deflation(gpu::Context& context, const gpu::Image& stencil, glm::ivec3 cells,
                     const std::vector<Roughness>& media) {
  const int channels = static_cast<int>(media.size());
  std::vector<Islands> found(channels);
  for (const Roughness& medium : media) {
    noise_ = std::max(noise_, noise_share(medium));
    rough_ = rough_ || is_rough(medium);
  }
  if (std::any_of(media.begin(), media.end(), may_have_islands)) {
    const gpu::Buffer copy = gpu::host_copy(context, stencil);
    const std::size_t each = copy.bytes() / sizeof(float) / channels;
    const float* all = static_cast<const float*>(copy.mapped());
    tbb::parallel_for(0, channels, [&](int c) {
      if (may_have_islands(media[c]))
        found[c] = find_islands(cells, std::span(all + c * each, each));
      else
        found[c].labels.assign(std::size_t(cells.x) * cells.y * cells.z, 0);
    });
  }
  std::vector<std::uint32_t> labels, entries;
  std::vector<IslandPiece> pieces;
  std::vector<IslandPieces> islands;
  for (int c = 0; c < channels; ++c) {
    const auto before = static_cast<std::uint32_t>(entries.size()), first = static_cast<std::uint32_t>(islands.size());
    for (std::uint32_t& label : found[c].labels) label += label > 0 ? first : 0;
    labels.insert(labels.end(), found[c].labels.begin(), found[c].labels.end());
    for (const IslandSpan& span : found[c].spans) {
      islands.push_back({static_cast<std::uint32_t>(pieces.size()), 0, span.weight});
      for (std::uint32_t begin = span.cells; begin < span.end; begin += DIFFUSION_ISLAND_PIECE)
        pieces.push_back({before + begin, before + std::min(begin + DIFFUSION_ISLAND_PIECE, span.end), c});
      islands.back().end = static_cast<std::uint32_t>(pieces.size());
    }
    entries.insert(entries.end(), found[c].entries.begin(), found[c].entries.end());
  }
  count_ = static_cast<int>(islands.size());
  pieces_ = static_cast<std::uint32_t>(pieces.size());
  if (count_ == 0) labels.assign(4, 0);
  labels_ = gpu::make_buffer(context, labels, "diffusion island labels");
  lifts_ = gpu::make_buffer(context, std::vector<float>(count_ + 1), "diffusion island lifts");
  if (count_ == 0) return;
  piece_list_ = gpu::make_buffer(context, pieces, "diffusion island pieces");
  pieces_of_ = gpu::make_buffer(context, islands, "diffusion islands");
  sums_ = gpu::Buffer(context, pieces.size() * sizeof(float), "diffusion island sums");
  entries_ = gpu::make_buffer(context, entries, "diffusion island entries");
}

}  // namespace alabaster
