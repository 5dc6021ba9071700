/// MUMPS, sequential: multifrontal LU, LDL^T and LL^T factorisation. ICNTL, CNTL, INFOG and RINFOG are numbered as in
/// its users' guide, from 1.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_MUMPS

#include <dmumps_c.h>

#include <new>
#include <stdexcept>

namespace stickslip {
namespace {

constexpr int job_initialise = -1, job_terminate = -2, job_analyse = 1, job_factorise = 2, job_solve = 3;
constexpr int use_comm_world = -987654;  // the users' guide's number for MPI_COMM_WORLD
constexpr int ordering_amd = 0, ordering_pord = 4;
constexpr int columns_at_a_time = 32;  // of a block of right-hand sides

}  // namespace

struct MumpsFactor::Data {
  std::shared_ptr<const Pattern> pattern;
  Symmetry symmetry;
  DMUMPS_STRUC_C mumps{};
  std::vector<MUMPS_INT> row, column;  ///< from 1; the lower triangle alone where symmetric
  std::vector<int> entry;              ///< place in the pattern of each, where symmetric
  std::vector<double> lower;           ///< values of those

  Data(std::shared_ptr<const Pattern> p, Symmetry s) : pattern(std::move(p)), symmetry(s) {
    mumps.sym = s == Symmetry::general ? 0 : s == Symmetry::positive_definite ? 1 : 2;
    mumps.par = 1;
    mumps.comm_fortran = use_comm_world;
    run(job_initialise);
    for (int i : {1, 2, 3}) icntl(i) = -1;  // no output unit
    icntl(4) = 0;
    icntl(6) = 0;  // no column permutation by value: the pattern is analysed before there are values
    // PORD: SCOTCH and the automatic choice give another ordering, thus other bits, in each run. But PORD ends the
    // process on a complete graph, so matrices near that go to AMD; they have little to gain from an ordering.
    const long n = pattern->size, dense = n * n / 2;
    icntl(7) = pattern->nonzeros() >= dense ? ordering_amd : ordering_pord;
    icntl(10) = 0;  // LinearSolver refines where it pays
    icntl(24) = 1;  // null pivots are listed, so that a message can name them
    icntl(27) = columns_at_a_time;
    icntl(28) = 1;  // sequential analysis
    icntl(33) = 1;  // the determinant, of which its sign is wanted
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  ~Data() { run(job_terminate); }

  MUMPS_INT& icntl(int i) { return mumps.icntl[i - 1]; }
  int infog(int i) const { return mumps.infog[i - 1]; }
  /// A count: beyond 2^31 MUMPS tells millions, with a minus sign.
  long entries(int i) const {
    const long told = infog(i);
    return told < 0 ? -told * 1000000 : told;
  }
  /// Runs one job and returns INFOG(1): negative is an error.
  int run(int job) {
    mumps.job = job;
    dmumps_c(&mumps);
    return infog(1);
  }
};

MumpsFactor::MumpsFactor(std::shared_ptr<const Pattern> pattern, Symmetry symmetry)
    : data_(std::make_shared<Data>(std::move(pattern), symmetry)) {
  Data& d = *data_;
  const Pattern& p = *d.pattern;
  const bool symmetric = symmetry != Symmetry::general;
  for (int j = 0; j < p.size; ++j)
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      if (symmetric && p.row[e] < j) continue;
      d.row.push_back(p.row[e] + 1);
      d.column.push_back(j + 1);
      if (symmetric) d.entry.push_back(e);
    }
  d.lower.resize(d.entry.size());
  d.mumps.n = p.size;
  d.mumps.nnz = static_cast<MUMPS_INT8>(d.row.size());
  d.mumps.irn = d.row.data();
  d.mumps.jcn = d.column.data();
  const int status = d.run(job_analyse);
  if (status == -5 || status == -7 || status == -13) throw std::bad_alloc();
  if (status < 0)
    throw std::runtime_error("MUMPS could not analyse the matrix (INFOG(1) = " + std::to_string(status) + ")");
}

Factorisation MumpsFactor::factorise(const double* values) {
  using Outcome = Factorisation::Outcome;
  Data& d = *data_;
  if (d.symmetry == Symmetry::general) {
    d.mumps.a = const_cast<double*>(values);  // MUMPS has no const; it does not write
  } else {
    for (std::size_t e = 0; e < d.entry.size(); ++e) d.lower[e] = values[d.entry[e]];
    d.mumps.a = d.lower.data();
  }
  int status = d.run(job_factorise);
  // -8, -9: pivots delayed beyond what the analysis foresaw need more room, which ICNTL(14) gives in percent. What
  // is found stays for the next factorisation.
  while ((status == -8 || status == -9) && d.icntl(14) < 10000) {
    d.icntl(14) *= 2;
    status = d.run(job_factorise);
  }
  if (status == -13 || status == -8 || status == -9) throw std::bad_alloc();
  const bool cholesky = d.symmetry == Symmetry::positive_definite;
  // MUMPS goes on past a negative pivot, without the pivoting that such a matrix needs; INFOG(12) counts them.
  if (status == -40 || (status >= 0 && cholesky && d.infog(12) > 0))
    return {Outcome::not_positive_definite, "a pivot is not positive"};
  if (status == -10 || (status >= 0 && d.infog(28) > 0)) {
    const std::string which =
        status >= 0 && d.mumps.pivnul_list ? "pivot of row " + std::to_string(d.mumps.pivnul_list[0] - 1) : "a pivot";
    return {cholesky ? Outcome::not_positive_definite : Outcome::singular, which + " is zero"};
  }
  if (status < 0) return {Outcome::failed, "MUMPS: INFOG(1) = " + std::to_string(status)};
  // RINFOG(19): of the scaled matrix, whose entries are at most about 1. RINFOG(12): mantissa of the determinant
  return {Outcome::done, "", d.mumps.rinfog[19 - 1], d.mumps.rinfog[12 - 1] < 0 ? -1 : 1};
}

void MumpsFactor::solve(const Matrix<double>& b, Matrix<double>& x, Taken taken) {
  Data& d = *data_;
  x = b;
  d.mumps.rhs = x.data();
  d.mumps.nrhs = static_cast<MUMPS_INT>(b.cols());
  d.mumps.lrhs = d.mumps.n;
  d.icntl(9) = taken == Taken::transposed ? 2 : 1;
  if (d.run(job_solve) < 0) throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
}

std::string MumpsFactor::name() const {
  const char* kind[] = {" LU", " LL^T", " LDL^T"};
  return library() + kind[data_->mumps.sym] + (data_->icntl(7) == ordering_pord ? ", PORD" : ", AMD");
}

long MumpsFactor::factor_nonzeros() const { return data_->entries(29); }

long MumpsFactor::factor_bytes() const {
  return data_->entries(9) * static_cast<long>(sizeof(double)) +
         data_->entries(10) * static_cast<long>(sizeof(MUMPS_INT));
}

std::string MumpsFactor::library() { return "MUMPS " MUMPS_VERSION; }

}  // namespace stickslip

#endif
