#include "byre/slam/lens_mask.h"

#include <cmath>

namespace byre {
namespace {

constexpr int kMinTrials = 30;        // in the rest of the image, with which a frame says anything
constexpr double kCleanShare = 0.6;   // of what the rest shows: the least that a clean cell does
constexpr double kDirtyShare = 0.1;   // of the same: what is found behind dirt, mostly by chance
const double kProof = std::log(1e4);  // of dirt
// Dirt is more than one cell large, so a cell beside a dirty one is likely to be dirty before anything is seen of it.
const double kProofBesideDirt = std::log(1e2);
const double kSuspicious = std::log(10.0);  // cells that do not stand for the rest of the image

struct Count {
  int found = 0;
  int all = 0;

  double share() const { return static_cast<double>(found) / all; }
  Count operator-(const Count& other) const { return {found - other.found, all - other.all}; }
};

using Counts = std::array<Count, HiddenCells::kCells>;

Counts by_cell(std::span<const LensTrial> trials, const Rig& rig) {
  Counts counts{};
  for (const LensTrial& trial : trials) {
    Count& count = counts[HiddenCells::cell_of(trial.pixel, rig)];
    ++count.all;
    count.found += trial.is_found ? 1 : 0;
  }
  return counts;
}

// What a cell's trials in one frame add to its evidence. They are often of one thing, so that together they count for
// less than apart.
double evidence_of(const Count& here, double rest) {
  const double clean = kCleanShare * rest;
  const double dirty = kDirtyShare * rest;
  const double found = here.share();
  return std::sqrt(here.all) *
         (found * std::log(dirty / clean) + (1.0 - found) * std::log((1.0 - dirty) / (1.0 - clean)));
}

}  // namespace

bool LensMask::is_beside_dirt(std::size_t cell) const {
  constexpr auto kColumns = static_cast<std::size_t>(HiddenCells::kColumns);
  const std::size_t column = cell % kColumns;
  return (column > 0 && hidden_.is_hidden(cell - 1)) || (column + 1 < kColumns && hidden_.is_hidden(cell + 1)) ||
         (cell >= kColumns && hidden_.is_hidden(cell - kColumns)) ||
         (cell + kColumns < HiddenCells::kCells && hidden_.is_hidden(cell + kColumns));
}

void LensMask::note(std::span<const LensTrial> trials, const Rig& rig) {
  const Counts counts = by_cell(trials, rig);
  std::array<bool, HiddenCells::kCells> of_rest{};
  Count all_rest;
  for (std::size_t cell = 0; cell < counts.size(); ++cell) {
    of_rest[cell] = !hidden_.is_hidden(cell) && evidence_[cell] < kSuspicious;
    if (of_rest[cell]) all_rest = {all_rest.found + counts[cell].found, all_rest.all + counts[cell].all};
  }
  HiddenCells after = hidden_;
  for (std::size_t cell = 0; cell < counts.size(); ++cell) {
    const Count& here = counts[cell];
    const Count rest = of_rest[cell] ? all_rest - here : all_rest;
    if (here.all == 0 || rest.all < kMinTrials || rest.found == 0) continue;
    double& evidence = evidence_[cell];
    evidence = std::clamp(evidence + evidence_of(here, rest.share()), 0.0, kProof);
    if (evidence >= (is_beside_dirt(cell) ? kProofBesideDirt : kProof)) after.set(cell, true);
    if (evidence == 0.0) after.set(cell, false);
  }
  hidden_ = after;
}

}  // namespace byre
