# The goals that write reports. ARGS='...' goes to the tool. With QUICK=1 each runs in minutes, coarse
# and short, and writes to build/quick instead of docs.
#
#   make validate        run the article's five cases: docs/results/validation.md: hours; it goes on
#                        where it was interrupted
#   make accuracy        run what is missing of the accuracy study, write docs/results/accuracy.md (ARGS=--list)
#   make coverage        whether the bands of tools/refine.py hold known answers: docs/results/coverage.md
#   make forecast        what --explain foresees against what runs take (idle machine): docs/results/accuracy.md
#   make stability       run the hard cases in their long form and write docs/results/stability.md; goes on where
#                        it was interrupted
#   make stability-map   1440 plates over density, thickness and stiffness: docs/results/stability_map.json, picture
#   make verify-fluid    rest, waves, impact, openings with both schemes: docs/results/fluid_verification.md
#   make verify-contact  restitution, pressure, friction, stacks, folds: docs/results/contact_verification.md
#   make verify-open     a vortex, a weir, a reversal with open boundaries: docs/results/open_verification.md
#   make verify-rigid    heave, water entry, waves and their damping: docs/results/rigid_verification.md
#   make verify-beam     beams alone, in water, for the gate, the baffle and the bar: docs/results/beam_verification.md
#   make verify-manufactured  orders of convergence against manufactured solutions: docs/results/manufactured.md
#   make exact-fsi       bodies and fluid against exact solutions: docs/results/exact_fsi.md
#   make turek-hron      docs/results/turek_hron.md from the kept runs (ARGS='run fsi2 --across 10' runs a case)
#   make performance     the bench, longest steps and the gate: docs/performance.md
#   make glance          the charts of the README from the results of the reports
#   make gallery         run valve, flap and floating plate, draw their pictures in the README
#   make reliability     run the fault tests and write docs/results/reliability.md

# goal: the tool and its options. Each is run on the built program by the project's Python.
validate_TOOL            := tools/report/validation.py
accuracy_TOOL            := tools/report/accuracy.py
coverage_TOOL            := tools/report/coverage.py
forecast_TOOL            := tools/report/forecast.py
stability_TOOL           := tools/report/stability.py --report $(if $(QUICK),--quick,--keep)
stability-map_TOOL       := tools/report/stability_map.py
verify-fluid_TOOL        := tools/report/verify_fluid.py
verify-contact_TOOL      := tools/report/verify_contact.py
verify-open_TOOL         := tools/report/verify_open.py
verify-rigid_TOOL        := tools/report/verify_rigid.py
verify-beam_TOOL         := tools/report/verify_beam.py
verify-manufactured_TOOL := tools/report/manufactured.py
exact-fsi_TOOL           := tools/report/exact_fsi.py
turek-hron_TOOL          := tools/report/turek_hron.py
performance_TOOL         := tools/report/performance.py
bench_TOOL               := tools/report/performance.py --bench
glance_TOOL              := tools/report/glance.py
reliability_TOOL         := tests/fault/reliability.py
REPORTS := $(patsubst %_TOOL,%,$(filter %_TOOL,$(.VARIABLES)))

.PHONY: $(REPORTS) help-reports gallery
export QUICK
$(REPORTS): $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' BUILD='$(B)' $(PROJECT_PYTHON) $($@_TOOL) $(ARGS)
	$(if $(filter accuracy,$@),@$(MAKE) --no-print-directory all)

# What a report runs beside the program. Several runs at a time must not spin while they wait.
validate stability-map: export OMP_WAIT_POLICY := passive
verify-manufactured exact-fsi coverage: $(SHARED)
bench performance: $(BENCHES)
reliability: $(TESTS)

help-reports:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' tools/report/report.mk

# Those that the documents show: name of the picture, case, time of the snapshot.
GALLERY := $(if $(QUICK),build/quick,runs)
gallery: $(PROGRAM)
	@mkdir -p $(GALLERY)
	@set -e; for row in 'elastic_valve elastic_valve 0.75' 'flap templates/flap 6' \
	  'floating_plate templates/floating_plate 6.3'; do \
	  set -- $$row; name=$$1; case=$$2; time=$$3; run=$(GALLERY)/$$name; \
	  [ -e $$run/summary.json ] || ./$(PROGRAM) cases/$$case.cfg --quiet --out $$run \
	    $(if $(QUICK),--set 'dp=4 mm' --until 0.05); \
	  picture=$(if $(QUICK),build/quick,docs/img)/$$name.png; \
	  $(PROJECT_PYTHON) tools/plot_fields.py $$run --time $(if $(QUICK),0.05,$$time) \
	    --field velocity --out $$picture; \
	  $(PROJECT_PYTHON) tools/report/palette.py $$picture; \
	done
