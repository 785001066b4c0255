/* SPDX-License-Identifier: Apache-2.0 */
/* Small symmetric positive definite systems, against the products they are made of. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "algebra/spd.h"
#include "truth_project.h"

/* root root^T + a little, whose rows and columns count in units of their own. */
static void make_definite(uint64_t *random, int n, const double *unit, double *matrix)
{
    double root[SPD_SIZE_MAX * SPD_SIZE_MAX];
    for (int i = 0; i < n * n; ++i) {
        root[i] = truth_gauss(random);
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            double sum = i == j ? 0.1 : 0.0;
            for (int k = 0; k < n; ++k) {
                sum += root[i * n + k] * root[j * n + k];
            }
            matrix[i * n + j] = sum * unit[i] * unit[j];
        }
    }
}

static void multiply(const double *matrix, int n, const double *x, double *b)
{
    for (int i = 0; i < n; ++i) {
        b[i] = 0.0;
        for (int j = 0; j < n; ++j) {
            b[i] += matrix[i * n + j] * x[j];
        }
    }
}

static void fill_units(int n, double span, double *unit)
{
    for (int i = 0; i < n; ++i) {
        unit[i] = pow(10.0, n > 1 ? span * i / (n - 1) : 0.0);
    }
}

static void a_definite_system_is_solved(void)
{
    uint64_t random = 3;
    for (int n = 1; n <= SPD_SIZE_MAX; ++n) {
        double unit[SPD_SIZE_MAX], matrix[SPD_SIZE_MAX * SPD_SIZE_MAX];
        double x[SPD_SIZE_MAX], b[SPD_SIZE_MAX];
        fill_units(n, 0.0, unit);
        make_definite(&random, n, unit, matrix);
        for (int i = 0; i < n; ++i) {
            x[i] = truth_gauss(&random);
        }
        multiply(matrix, n, x, b);
        TEST_ASSERT_TRUE(spd_factor(matrix, n, SPD_PIVOT_LEAST));
        spd_solve(matrix, n, b);
        for (int i = 0; i < n; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, x[i], b[i]);
        }
    }
}

static void unknowns_that_differ_by_twelve_orders_are_solved_for(void)
{
    uint64_t random = 4;
    const int n = 9;
    double unit[SPD_SIZE_MAX], matrix[SPD_SIZE_MAX * SPD_SIZE_MAX];
    double x[SPD_SIZE_MAX], b[SPD_SIZE_MAX];
    fill_units(n, 12.0, unit);
    make_definite(&random, n, unit, matrix);
    for (int i = 0; i < n; ++i) {
        x[i] = truth_gauss(&random) / unit[i];
    }
    multiply(matrix, n, x, b);
    TEST_ASSERT_TRUE(spd_solve_scaled(matrix, n, 0.0, SPD_PIVOT_LEAST, b));
    for (int i = 0; i < n; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, x[i] * unit[i], b[i] * unit[i]);
    }
}

static void damping_is_added_to_a_diagonal_of_ones(void)
{
    double matrix[4] = {4.0, 0.0, 0.0, 100.0}, b[2] = {8.0, 300.0};
    TEST_ASSERT_TRUE(spd_solve_scaled(matrix, 2, 1.0, 0.0, b));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, b[0]); /* half of 8 / 4 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5, b[1]);
}

static void only_the_lower_triangle_is_read(void)
{
    double matrix[4] = {4.0, NAN, 2.0, 3.0};
    TEST_ASSERT_TRUE(spd_invert(matrix, 2, SPD_PIVOT_LEAST));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0 / 8.0, matrix[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.0 / 8.0, matrix[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.0 / 8.0, matrix[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4.0 / 8.0, matrix[3]);
}

static void the_inverse_times_the_matrix_is_the_identity(void)
{
    uint64_t random = 5;
    for (int n = 1; n <= SPD_SIZE_MAX; ++n) {
        double unit[SPD_SIZE_MAX], matrix[SPD_SIZE_MAX * SPD_SIZE_MAX];
        double inverse[SPD_SIZE_MAX * SPD_SIZE_MAX], column[SPD_SIZE_MAX], product[SPD_SIZE_MAX];
        fill_units(n, 8.0, unit);
        make_definite(&random, n, unit, matrix);
        memcpy(inverse, matrix, sizeof inverse);
        TEST_ASSERT_TRUE(spd_invert(inverse, n, SPD_PIVOT_LEAST));
        for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
                column[i] = inverse[i * n + j];
                TEST_ASSERT_EQUAL_DOUBLE(column[i], inverse[j * n + i]);
            }
            multiply(matrix, n, column, product);
            for (int i = 0; i < n; ++i) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-8, i == j ? 1.0 : 0.0, product[i] * unit[j] / unit[i]);
            }
        }
    }
}

static void refuses(const double *values, int n, double least)
{
    double matrix[4], b[2] = {1.0, 1.0};
    memcpy(matrix, values, (size_t)(n * n) * sizeof *matrix);
    TEST_ASSERT_FALSE(spd_factor(matrix, n, least));
    memcpy(matrix, values, (size_t)(n * n) * sizeof *matrix);
    TEST_ASSERT_FALSE(spd_invert(matrix, n, least));
    memcpy(matrix, values, (size_t)(n * n) * sizeof *matrix);
    TEST_ASSERT_FALSE(spd_solve_scaled(matrix, n, 0.0, least, b));
}

static void a_system_that_is_not_definite_is_refused(void)
{
    const double singular[4] = {1.0, 2.0, 2.0, 4.0};
    const double negative[4] = {1.0, 3.0, 3.0, 1.0};
    const double nothing[1] = {0.0};
    const double broken[1] = {NAN};
    const double nearly[4] = {1.0, 1.0, 1.0, 1.0 + 1e-6};
    refuses(singular, 2, SPD_PIVOT_LEAST);
    refuses(negative, 2, SPD_PIVOT_LEAST);
    refuses(nothing, 1, SPD_PIVOT_LEAST);
    refuses(broken, 1, SPD_PIVOT_LEAST);
    refuses(nearly, 2, 1e-5);
}

void setUp(void) {}
void tearDown(void) {}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_definite_system_is_solved);
    RUN_TEST(unknowns_that_differ_by_twelve_orders_are_solved_for);
    RUN_TEST(damping_is_added_to_a_diagonal_of_ones);
    RUN_TEST(only_the_lower_triangle_is_read);
    RUN_TEST(the_inverse_times_the_matrix_is_the_identity);
    RUN_TEST(a_system_that_is_not_definite_is_refused);
    return UNITY_END();
}
