#include "diffusion/history.h"

#include <algorithm>

namespace alabaster {
namespace {

constexpr double nothing_new = 1e-11;  // of the energy; solutions themselves have a residual of 1e-6

}  // namespace

SolutionHistory::SolutionHistory(gpu::Context& context, const DiffusionPasses& passes, Multigrid& multigrid, Pcg& pcg)
    : context_(context), passes_(passes), multigrid_(multigrid), pcg_(pcg) {
  const int channels = multigrid.channels();
  const glm::ivec3 cells = multigrid.finest().cells;
  for (gpu::Image& v : kept_) v = packed_image(context, cells, channels, 1, "solution of before");
  product_ = packed_image(context, cells, channels, 1, "product");
  sums_ = gpu::Buffer(context, std::size_t(channels) * pcg.partials_per_channel() * sizeof(glm::vec4),
                      "diffusion projections");
  coefficients_ = gpu::Buffer(context, channels * sizeof(glm::vec4), "diffusion coefficients", gpu::Memory::host);
  gpu::Commands commands(context);
  commands.fill(sums_);
  commands.submit();
  forget();
}

void SolutionHistory::forget() { energies_.assign(multigrid_.channels(), Sums{}); }

std::vector<SolutionHistory::Sums> SolutionHistory::products() {
  gpu::Commands commands(context_);
  commands.dispatch(passes_.project, multigrid_.threads(0),
                    {{"bricks", multigrid_.bricks().packed},
                     {"b", pcg_.rhs()},
                     {"sums", sums_},
                     {"v0", kept_[0]},
                     {"v1", kept_[1]},
                     {"v2", kept_[2]},
                     {"v3", kept_[3]}},
                    LevelPush{multigrid_.finest().cells, {}, 0, 0});
  commands.submit();
  const std::vector<glm::vec4> parts = gpu::download<glm::vec4>(context_, sums_);
  std::vector<Sums> sums(multigrid_.channels(), Sums{});
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (int k = 0; k < depth; ++k) sums[i / pcg_.partials_per_channel()][k] += parts[i][k];
  return sums;
}

void SolutionHistory::blend(float step, const gpu::Image& x, const std::vector<glm::vec4>& coefficients,
                            const gpu::Image& to) {
  gpu::upload(context_, coefficients_, coefficients);
  gpu::Commands commands(context_);
  commands.dispatch(passes_.blend, multigrid_.threads(0),
                    {{"bricks", multigrid_.bricks().packed},
                     {"x", x},
                     {"coefficients", coefficients_},
                     {"v0", kept_[0]},
                     {"v1", kept_[1]},
                     {"v2", kept_[2]},
                     {"v3", kept_[3]},
                     {"blended", to}},
                    LevelPush{multigrid_.finest().cells, {}, 0, step});
  commands.submit();
}

std::vector<double> SolutionHistory::energies(const gpu::Image& v) {
  gpu::Commands commands(context_);
  commands.dispatch(passes_.apply_dot, multigrid_.column_threads(),
                    {{"bricks", multigrid_.columns().packed},
                     {"stencil", multigrid_.finest().stencil},
                     {"x", v},
                     {"partials", pcg_.partials()},
                     {"product", product_}},
                    LevelPush{multigrid_.finest().cells, {}, 0, 0});
  commands.submit();
  const std::vector<float> parts = gpu::download<float>(context_, pcg_.partials());
  std::vector<double> sums(multigrid_.channels());
  for (std::size_t i = 0; i < sums.size() * multigrid_.columns().count; ++i)
    sums[i / multigrid_.columns().count] += parts[i];
  return sums;
}

bool SolutionHistory::guess() {
  const std::vector<Sums> sums = products();
  std::vector<glm::vec4> coefficients(sums.size(), glm::vec4(0));
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (std::all_of(energies_[c].begin(), energies_[c].end(), [](double e) { return e == 0; })) return false;
    for (int k = 0; k < depth; ++k)
      if (energies_[c][k] > 0) coefficients[c][k] = static_cast<float>(sums[c][k] / energies_[c][k]);
  }
  blend(0, pcg_.solution(), coefficients, pcg_.solution());
  gpu::Commands commands(context_);
  commands.clear(pcg_.solution_rest());
  commands.submit();
  return true;
}

void SolutionHistory::add() {
  for (Sums& e : energies_) e[next_] = 0;
  const std::vector<Sums> sums = products();
  std::vector<glm::vec4> coefficients(sums.size(), glm::vec4(0));
  std::vector<double> known(sums.size());  // of the new solution's energy
  for (std::size_t c = 0; c < sums.size(); ++c)
    for (int k = 0; k < depth; ++k)
      if (energies_[c][k] > 0) {
        coefficients[c][k] = static_cast<float>(-sums[c][k] / energies_[c][k]);
        known[c] += sums[c][k] * sums[c][k] / energies_[c][k];
      }
  blend(1, pcg_.solution(), coefficients, kept_[next_]);
  const std::vector<double> fresh = energies(kept_[next_]);
  bool any = false;
  for (std::size_t c = 0; c < sums.size(); ++c)
    if (fresh[c] > nothing_new * (known[c] + fresh[c])) {
      energies_[c][next_] = fresh[c];
      any = true;
    }
  if (any) next_ = (next_ + 1) % depth;
}

}  // namespace alabaster
