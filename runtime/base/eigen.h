/* Eigenvalues and vectors of small symmetric matrices by Jacobi's rotations (Jacobi 1846; Golub and
   Van Loan 1996, 8.4), whose bits, unlike LAPACK's, do not depend on the processor. */
#ifndef PERILAT_RUNTIME_EIGEN_H
#define PERILAT_RUNTIME_EIGEN_H

enum { EIGEN_MOST = 6 };

/* a[order][order], order <= EIGEN_MOST, becomes diagonal: values[m] belongs to vectors[m]. In no
   particular order; errors are a few ulp of the largest. */
void eigen_symmetric(int order, double a[EIGEN_MOST][EIGEN_MOST], double values[EIGEN_MOST],
                     double vectors[EIGEN_MOST][EIGEN_MOST]);

#endif
