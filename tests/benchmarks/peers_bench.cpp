#include <benchmark/benchmark.h>
#include <faiss/IndexFlat.h>
#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/bayes/CParticleFilterData.h>
#include <mrpt/random/RandomGenerators.h>
#include <omp.h>

#include "tests/benchmarks/match_world.hpp"

// Packaged peers at the same tasks as wayfuse's own parts in engine_bench.cpp, one thread each.
namespace wayfuse {
namespace {

// FAISS, exact: every point of the survey as a dense vector.
void match_faiss_flat(benchmark::State& state) {
  omp_set_num_threads(1);
  const MatchWorld& world = match_world(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  const std::size_t columns = world.map->transmitters().size();
  faiss::IndexFlatL2 index(static_cast<faiss::Index::idx_t>(columns));
  index.add(static_cast<faiss::Index::idx_t>(world.map->points().size()), world.dense.data());
  std::vector<float> wanted;
  KnownScan known;
  std::size_t turn = 0;
  for (auto _ : state) {
    dense_row(world, world.scans[turn++ % world.scans.size()], known, wanted);
    float distance = 0.0f;
    faiss::Index::idx_t best = -1;
    index.search(1, wanted.data(), 1, &distance, &best);
    benchmark::DoNotOptimize(best);
  }
}
BENCHMARK(match_faiss_flat)->Args({10000, 500})->Unit(benchmark::kMicrosecond);

struct Walker {
  double x_m = 0.0, y_m = 0.0;
};

// MRPT's particle filter with the walk and the measurement of particles_wayfuse.
class MrptWalkers final : public mrpt::bayes::CParticleFilterData<Walker, mrpt::bayes::particle_storage_mode::VALUE>,
                          public mrpt::bayes::CParticleFilterDataImpl<
                              MrptWalkers, mrpt::bayes::CParticleFilterData<Walker, mrpt::bayes::particle_storage_mode::VALUE>::CParticleList> {
 public:
  MrptWalkers() { m_particles.resize(kParticles); }
  double truth_m = 0.0;

  void prediction_and_update_pfStandardProposal(const mrpt::obs::CActionCollection*, const mrpt::obs::CSensoryFrame*,
                                                const mrpt::bayes::CParticleFilter::TParticleFilterOptions&) override {
    auto& random = mrpt::random::getRandomGenerator();
    for (auto& particle : m_particles) {
      particle.d.x_m += 0.7 + 0.3 * random.drawGaussian1D_normalized();
      particle.d.y_m += 0.3 * random.drawGaussian1D_normalized();
      const double dx = particle.d.x_m - truth_m, dy = particle.d.y_m;
      particle.log_w -= (dx * dx + dy * dy) / 18.0;
    }
  }
};

void particles_mrpt(benchmark::State& state) {
  mrpt::bayes::CParticleFilter filter;
  filter.m_options.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
  filter.m_options.resamplingMethod = mrpt::bayes::CParticleFilter::prSystematic;
  filter.m_options.BETA = 1.0;  // resample every time, as the others do
  MrptWalkers walkers;
  for (auto _ : state) {
    walkers.truth_m += 0.7;
    filter.executeOn(walkers, nullptr, nullptr);
  }
  state.counters["a particle"] = time_per_particle();
}
BENCHMARK(particles_mrpt);

}  // namespace
}  // namespace wayfuse
