#include "domain/domain.h"

#include <algorithm>
#include <cmath>

#include "scene/error.h"

namespace alabaster {

namespace {

constexpr std::uint32_t cells_an_item = 64;     // as in shaders/domain/triangles.glsl
constexpr std::size_t sums_bytes = 6 * 19 * 4;  // of a candidate cell, as in shaders/domain/sums.glsl
constexpr double fixed_one = 16777216;          // likewise
constexpr double folded_share = 0.01;           // of the cut cells: scanned meshes have folds of a few triangles
static_assert(sizeof(GpuFacet) == 32 && sizeof(GpuCutCell) == 160 && sizeof(DomainPush) == 16);

struct Item {
  std::uint32_t triangle, first;
};

struct Total {
  float volume, area;
  glm::vec3 area_vector;
};

/// A triangle's bounding box, cut into runs of cells that one thread can walk.
std::vector<Item> make_items(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles) {
  std::vector<Item> items;
  items.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    glm::vec3 a = positions[triangles[t].x], b = positions[triangles[t].y], c = positions[triangles[t].z];
    glm::vec3 low = glm::floor(glm::min(glm::min(a, b), c)), high = glm::ceil(glm::max(glm::max(a, b), c));
    glm::uvec3 size = glm::max(glm::uvec3(high - low), 1u);  // of a flat box: one layer
    for (std::uint32_t first = 0; first < size.x * size.y * size.z; first += cells_an_item) items.push_back({t, first});
  }
  return items;
}

std::uint32_t words_of(std::size_t bits) { return std::uint32_t((bits + 31) / 32); }

/// Scratch that must not be empty even where there is nothing to put in it.
gpu::Buffer scratch(gpu::Context& context, std::size_t bytes, const char* name) {
  return gpu::Buffer(context, std::max<std::size_t>(bytes, 16), name);
}

}  // namespace

/// A set of numbered bits on the device, with ranks: see scan.comp.
struct BitSet {
  BitSet(gpu::Context& context, std::size_t count)
      : words(words_of(count)),
        bits(context, words * 4, "domain bits"),
        before(context, words * 4, "domain bits before"),
        total(context, 12, "domain bits in all") {}
  std::uint32_t words;
  gpu::Buffer bits, before, total;
};

/// The making of one domain: three submissions, because two counts decide the sizes of buffers.
class DomainBuild {
 public:
  DomainBuild(const DomainMaker& maker, const Mesh& mesh, const GridFrame& frame)
      : maker_(maker),
        context_(maker.context_),
        cell_count_(std::size_t(frame.cells.x) * frame.cells.y * frame.cells.z),
        candidates_(context_, cell_count_),
        cuts_(context_, cell_count_),
        slits_(context_, cell_count_ / 4),
        status_(context_, sizeof(DomainStatus), "domain status") {
    out_.frame = frame;
    std::vector<glm::vec3> positions = grid_positions(mesh, frame);
    std::vector<Item> items = make_items(positions, mesh.triangles);
    item_count_ = std::uint32_t(items.size());
    positions_ = gpu::make_buffer(context_, positions, "domain positions");
    triangles_ = gpu::make_buffer(context_, mesh.triangles, "domain triangles");
    items_ = gpu::make_buffer(context_, items, "domain items");
  }

  Domain run() {
    find_candidates();
    add_up();
    finish();
    summarise();
    return std::move(out_);
  }

 private:
  DomainPush push(std::size_t count) const { return {out_.frame.cells, std::uint32_t(count)}; }

  void scan(gpu::Commands& commands, const BitSet& set) const {
    commands.dispatch(maker_.scan_, {1, 1, 1}, {{"bits", set.bits}, {"before", set.before}, {"total", set.total}},
                      set.words);
  }
  void list(gpu::Commands& commands, const BitSet& set, const gpu::Buffer& to) const {
    commands.dispatch(maker_.list_, {set.words, 1, 1}, {{"bits", set.bits}, {"before", set.before}, {"list", to}},
                      set.words);
  }
  std::uint32_t total(const BitSet& set) const { return gpu::download<std::uint32_t>(context_, set.total)[0]; }

  DomainStatus read_status() const { return gpu::download<DomainStatus>(context_, status_)[0]; }

  void find_candidates() {
    gpu::Commands commands(context_);
    {
      auto timer = commands.time("domain/mark");
      for (const BitSet* set : {&candidates_, &cuts_, &slits_}) commands.fill(set->bits);
      commands.fill(status_);
      commands.barrier();
      commands.dispatch(maker_.mark_, {item_count_, 1, 1},
                        {{"positions", positions_},
                         {"triangles", triangles_},
                         {"items", items_},
                         {"bits", candidates_.bits},
                         {"status", status_}},
                        push(item_count_));
      scan(commands, candidates_);
    }
    commands.submit();
    candidate_count_ = total(candidates_);
    pair_count_ = read_status().pairs;
    if (candidate_count_ * sums_bytes > context_.limits().maxStorageBufferRange ||
        pair_count_ / 64 >= context_.limits().maxComputeWorkGroupCount[0]) {
      throw UserError("grid: " + std::to_string(candidate_count_) +
                      " cells meet the surface, too many for this device; choose a smaller --grid");
    }
  }

  void add_up() {
    sums_ = scratch(context_, candidate_count_ * sums_bytes, "domain sums");
    faces_ = scratch(context_, candidate_count_ * std::size_t(48), "domain faces");
    gifts_ = scratch(context_, candidate_count_ * std::size_t(4), "domain gifts");
    gpu::Buffer candidate_list = scratch(context_, candidate_count_ * std::size_t(4), "domain candidates");
    gpu::Buffer pairs = scratch(context_, pair_count_ * sizeof(glm::uvec2), "domain pairs");
    glm::ivec3 texels(out_.frame.cells.x / 4, out_.frame.cells.y, out_.frame.cells.z);
    const char* names[] = {"domain aperture x", "domain aperture y", "domain aperture z"};
    for (int i = 0; i < 3; ++i) {
      out_.aperture[i] = gpu::image3d(context_, texels, VK_FORMAT_R32G32B32A32_SFLOAT, names[i]);
    }

    gpu::Commands commands(context_);
    {
      auto timer = commands.time("domain/accumulate");
      commands.fill(sums_);
      list(commands, candidates_, candidate_list);
      commands.barrier();
      commands.dispatch(maker_.pair_, {item_count_, 1, 1},
                        {{"positions", positions_},
                         {"triangles", triangles_},
                         {"items", items_},
                         {"pairs", pairs},
                         {"status", status_}},
                        push(item_count_));
      commands.dispatch(maker_.accumulate_, {pair_count_, 1, 1},
                        {{"positions", positions_},
                         {"triangles", triangles_},
                         {"pairs", pairs},
                         {"bits", candidates_.bits},
                         {"before", candidates_.before},
                         {"sums", sums_}},
                        push(pair_count_));
    }
    {
      auto timer = commands.time("domain/candidate");
      commands.dispatch(maker_.candidate_, {candidate_count_, 1, 1},
                        {{"bits", candidates_.bits},
                         {"before", candidates_.before},
                         {"sums", sums_},
                         {"list", candidate_list},
                         {"gifts", gifts_},
                         {"cut_bits", cuts_.bits},
                         {"slit_bits", slits_.bits},
                         {"status", status_},
                         {"faces", faces_}},
                        push(candidate_count_));
      scan(commands, cuts_);
      scan(commands, slits_);
    }
    {
      auto timer = commands.time("domain/sweep");
      commands.concurrent([&] {
        for (int i = 0; i < 3; ++i) sweep(commands, i, texels);
      });
    }
    commands.submit();
    out_.summary.cut_cells = total(cuts_);
    slit_texels_ = total(slits_);
  }

  void sweep(gpu::Commands& commands, int axis, glm::ivec3 texels) const {
    const gpu::Pass* passes[] = {&maker_.sweep_x_, &maker_.sweep_y_, &maker_.sweep_z_};
    glm::uvec3 threads(texels[axis == 0 ? 1 : 0], texels[axis == 2 ? 1 : 2], 1);
    commands.dispatch(*passes[axis], threads,
                      {{"bits", candidates_.bits},
                       {"before", candidates_.before},

                       {"faces", faces_},
                       {"status", status_},
                       {"aperture", out_.aperture[axis]}},
                      push(0));
  }

  void finish() {
    std::uint32_t count = out_.summary.cut_cells;
    glm::ivec3 texels = out_.aperture[0].spec().size;
    out_.volume = gpu::image3d(context_, texels, VK_FORMAT_R32G32B32A32_SFLOAT, "domain volume");
    out_.cut_index = gpu::image3d(context_, out_.frame.cells, VK_FORMAT_R32_UINT, "domain cut index");
    out_.cut_cells = gpu::Buffer(context_, (count + std::size_t(1)) * sizeof(GpuCutCell), "domain cut cells");
    totals_ = scratch(context_, (count + std::size_t(63)) / 64 * sizeof(Total), "domain totals");
    gpu::Buffer cut_list = scratch(context_, count * std::size_t(4), "domain cut list");
    gpu::Buffer slit_list = scratch(context_, slit_texels_ * std::size_t(4), "domain slit texels");
    gpu::Buffer plain = gpu::make_buffer(context_, std::vector<GpuCutCell>{plain_cell()}, "domain plain cell");

    gpu::Commands commands(context_);
    {
      auto timer = commands.time("domain/finish");
      commands.copy(plain, out_.cut_cells, sizeof(GpuCutCell));
      list(commands, cuts_, cut_list);
      commands.dispatch(slit_texels_ > 0 ? maker_.finish_parted_ : maker_.finish_, {count, 1, 1},
                        {{"bits", candidates_.bits},
                         {"before", candidates_.before},
                         {"sums", sums_},
                         {"cut_list", cut_list},
                         {"gifts", gifts_},
                         {"faces", faces_},
                         {"cut_cells", out_.cut_cells},
                         {"aperture_x", out_.aperture[0]}},
                        push(count));
      commands.dispatch(maker_.totals_, {count, 1, 1}, {{"cut_cells", out_.cut_cells}, {"totals", totals_}}, count);
    }
    {
      auto timer = commands.time("domain/dense");
      fill_dense(commands, texels);
      if (slit_texels_ > 0) part(commands, slit_list, slit_texels_);
    }
    commands.submit();
  }

  void part(gpu::Commands& commands, const gpu::Buffer& texels, std::uint32_t count) const {
    list(commands, slits_, texels);
    commands.dispatch(maker_.part_, {count, 1, 1},
                      {{"bits", candidates_.bits},
                       {"before", candidates_.before},
                       {"sums", sums_},
                       {"list", texels},
                       {"gifts", gifts_},
                       {"faces", faces_},
                       {"aperture_x", out_.aperture[0]},
                       {"aperture_y", out_.aperture[1]},
                       {"aperture_z", out_.aperture[2]}},
                      push(count));
  }

  void fill_dense(gpu::Commands& commands, glm::ivec3 texels) const {
    commands.dispatch(maker_.dense_, glm::uvec3(texels),
                      {{"cut_bits", cuts_.bits},
                       {"cut_before", cuts_.before},
                       {"cut_cells", out_.cut_cells},
                       {"status", status_},
                       {"aperture_x", out_.aperture[0]},
                       {"aperture_y", out_.aperture[1]},
                       {"aperture_z", out_.aperture[2]},
                       {"volume", out_.volume},
                       {"cut_index", out_.cut_index}},
                      push(0));
  }

  static GpuCutCell plain_cell() {
    GpuCutCell cell{};
    cell.volume = 1;
    cell.centre = glm::vec3(0.5f);
    for (int i = 0; i < 3; ++i) {
      cell.low_face_centre[i] = glm::vec3(0.5f);
      cell.low_face_centre[i][i] = 0;
    }
    return cell;
  }

  void summarise() {
    DomainSummary& s = out_.summary;
    DomainStatus status = read_status();
    double h = out_.frame.h;
    s.inner_cells = status.inner_cells;
    s.slit_cells = status.slit_cells;
    s.worst_closure = status.closure / fixed_one;
    s.volume = status.inner_cells;
    for (const Total& t : gpu::download<Total>(context_, totals_)) {
      s.volume += t.volume;
      s.area += t.area;
      s.area_vector += glm::dvec3(t.area_vector);
    }
    s.volume *= h * h * h;
    s.area *= h * h;
    s.area_vector *= h * h;
    judge(status);
  }

  void judge(const DomainStatus& status) {
    const DomainSummary& s = out_.summary;
    if (status.crumpled_cells > 0) {
      throw UserError(
          "grid: " + std::to_string(status.crumpled_cells) +
          " cells hold too much surface (100 times a cell's face); choose a larger --grid or a simpler mesh");
    }
    if (s.worst_closure > 1e-3) throw UserError("mesh: it is not closed; close its holes");
    if (status.inverted_texels > folded_share * s.cut_cells)
      throw UserError("mesh: it, or a piece of it, is inside out; turn its triangles around");
    if (status.inverted_texels > 0)
      out_.warnings.push_back("the mesh is folded inside out in places; what lies in the folds is left out");
    if (s.cut_cells == 0) throw UserError("mesh: it has no surface; all its triangles are degenerate");
    if (status.overlapping_texels > 0) {
      out_.warnings.push_back("the mesh overlaps itself in places; volumes there are clamped");
    }
    if (s.slit_cells > 0) {
      out_.warnings.push_back(std::to_string(s.slit_cells) +
                              " cells hold a gap thinner than a cell; a finer grid resolves it");
    }
  }

  const DomainMaker& maker_;
  gpu::Context& context_;
  Domain out_;
  std::size_t cell_count_;
  std::uint32_t item_count_ = 0, pair_count_ = 0, candidate_count_ = 0, slit_texels_ = 0;
  BitSet candidates_, cuts_, slits_;
  gpu::Buffer status_, positions_, triangles_, items_, sums_, faces_, gifts_, totals_;
};

DomainMaker::DomainMaker(gpu::Context& context)
    : context_(context),
      mark_(context, "domain/mark.comp"),
      scan_(context, "domain/scan.comp"),
      list_(context, "domain/list.comp"),
      pair_(context, "domain/pair.comp"),
      accumulate_(context, "domain/accumulate.comp"),
      candidate_(context, "domain/candidate.comp"),
      sweep_x_(context, "domain/sweep.comp", {0}),
      sweep_y_(context, "domain/sweep.comp", {1}),
      sweep_z_(context, "domain/sweep.comp", {2}),
      finish_(context, "domain/finish.comp", {0}),
      finish_parted_(context, "domain/finish.comp", {1}),
      part_(context, "domain/part.comp"),
      dense_(context, "domain/dense.comp"),
      totals_(context, "domain/totals.comp") {}

Domain DomainMaker::make(const Mesh& mesh, const GridFrame& frame) const {
  if (mesh.triangles.empty()) throw UserError("mesh: it has no triangles");
  return DomainBuild(*this, mesh, frame).run();
}

Domain make_domain(gpu::Context& context, const Mesh& mesh, const GridFrame& frame) {
  return DomainMaker(context).make(mesh, frame);
}

}  // namespace alabaster
