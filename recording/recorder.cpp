#include "recording/recorder.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "core/assert.hpp"
#include "core/event_text.hpp"

namespace hybridtest {
namespace {

/// Values moved from a ring to the file at once, at most.
constexpr std::size_t kBlockValues = 32768;

std::vector<TableLayout> layouts_of(const std::vector<RecordedTable>& tables) {
  std::vector<TableLayout> layouts;
  for (const RecordedTable& table : tables) layouts.push_back(table.layout);
  return layouts;
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& path, const RunFileHeader& header, std::vector<RecordedTable> tables,
                   std::size_t event_sources, std::size_t events_per_source)
    : events_per_source_{events_per_source},
      taken_(tables.size() + 1),
      writer_{std::make_unique<RunFileWriter>(path, header, layouts_of(tables))} {
  for (const RecordedTable& table : tables) {
    const std::size_t width = table.layout.columns.size();
    table_names_.push_back(table.layout.name);
    rings_.push_back(std::make_unique<RowRing>(width, table.ring_rows));
    rows_.resize(std::max({rows_.size(), width, std::min(kBlockValues, width * table.ring_rows)}));
  }
  for (std::size_t i = 0; i < event_sources; ++i)
    event_rings_.push_back(std::make_unique<EventRing>(events_per_source));
}

Recorder::~Recorder() { close(); }

RowSink& Recorder::sink(std::string_view table) {
  const auto found = std::find(table_names_.begin(), table_names_.end(), table);
  HYBRIDTEST_ASSERT(found != table_names_.end());
  return *rings_[static_cast<std::size_t>(found - table_names_.begin())];
}

Outbox<Event>& Recorder::events(std::size_t source) {
  HYBRIDTEST_ASSERT(source < event_rings_.size());
  return *event_rings_[source];
}

int Recorder::error_number() const {
  // HDF5 passes it on only in its text.
  constexpr std::string_view kBefore = "errno = ";
  const std::string text = error_text();
  const auto place = text.find(kBefore);
  return place == std::string::npos ? 0 : std::atoi(text.c_str() + place + kBefore.size());
}

bool Recorder::should_drain() const noexcept {
  return std::any_of(rings_.begin(), rings_.end(),
                     [](const auto& ring) { return 2 * ring->size() >= ring->capacity(); });
}

void Recorder::fail(std::string text) noexcept {
  if (failed()) return;
  error_text_ = std::move(text);
  failed_.store(true, std::memory_order_release);
}

template <class Work>
void Recorder::attempt(Work&& work) noexcept {
  if (failed()) return;
  try {
    work();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void Recorder::drain_table(std::size_t table) {
  RowRing& ring = *rings_[table];
  const std::size_t block = rows_.size() / ring.row_width() * ring.row_width();
  // Only rows that were waiting at the start, so that a fast producer cannot prolong the loop.
  for (std::size_t waiting = ring.size(); waiting > 0;) {
    const std::size_t room = std::min(block, waiting * ring.row_width());
    const std::size_t taken = ring.take(std::span{rows_}.first(room));
    taken_[table] += taken;
    waiting -= taken;
    const std::span<const double> rows = std::span{rows_}.first(taken * ring.row_width());
    attempt([&] { writer_->append(table, rows); });
    if (observer_ != nullptr && taken > 0) observer_->see(table, rows);
  }
}

void Recorder::drain_events() {
  for (const auto& ring : event_rings_) {
    std::vector<Event> events;
    std::vector<std::string> texts;
    for (Event event; events.size() < events_per_source_ && ring->take(event);) {
      texts.push_back(describe(event));
      events.push_back(event);
    }
    taken_.back() += events.size();
    attempt([&] { writer_->append_events(events, texts); });
  }
}

void Recorder::count_losses() {
  std::uint64_t sum = 0;
  for (std::size_t table = 0; table < taken_.size(); ++table) {
    std::uint64_t lost = 0;
    if (table < rings_.size()) {
      lost = rings_[table]->dropped();
    } else {
      for (const auto& ring : event_rings_) lost += ring->dropped();
    }
    // Rows passed to a failed file since its last flush may be missing.
    if (failed()) lost += taken_[table] - writer_->rows_flushed(table);
    writer_->set_dropped(table, lost);
    sum += lost;
  }
  dropped_.store(sum, std::memory_order_relaxed);
}

void Recorder::drain() noexcept {
  if (closed_) return;
  for (std::size_t table = 0; table < rings_.size(); ++table) drain_table(table);
  drain_events();
  count_losses();
  attempt([&] { writer_->flush(); });
  if (failed()) count_losses();
  if (observer_ != nullptr) observer_->end_of_drain();
}

void Recorder::close() noexcept {
  if (closed_) return;
  drain();
  attempt([&] { writer_->close(); });
  if (failed()) count_losses();
  closed_ = true;
}

}  // namespace hybridtest
