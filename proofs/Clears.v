(* (i) 4 for such a drivetrain: by the clearing time the slowest ego has gone as far as planned. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Lag Drive Departs.
Open Scope R_scope.

Lemma total_app p q : total (p ++ q) = total p + total q.
Proof. induction p as [| [d e] p IH]; cbn; [ring | rewrite IH; ring]. Qed.

Section Clears.
Variables (k : drivetrain) (cap fade floor : R).
Hypothesis cap0 : 0 < cap.
Hypothesis fade0 : 0 <= fade.
Hypothesis floor0 : floor <= 0.

Let low_at := low_at cap fade floor.
Let after_low := after_low cap fade floor.
Let goes_on := goes_on cap fade floor.

Lemma low_at_app q : forall p r u, ordered p -> p <> nil -> u <= total p -> low_at r (p ++ q) u = low_at r p u.
Proof.
  induction p as [| [d a] p IH]; intros r u ord ne le; [contradiction |].
  inversion ord; subst. cbn [app]. unfold low_at in *. cbn [Departs.low_at total] in *.
  destruct (Rle_dec u d); [reflexivity |].
  destruct p as [| leg p]; [cbn in le; lra |]. apply IH; auto; [discriminate | lra].
Qed.

Lemma low_at_beyond q : forall p r u, ordered p -> total p < u -> low_at r (p ++ q) u = low_at (after_low p r) q (u - total p).
Proof.
  induction p as [| [d a] p IH]; intros r u ord lt.
  - cbn. rewrite Rminus_0_r. reflexivity.
  - inversion ord as [| ? ? d0 ord']; subst. cbn [fst] in d0. pose proof (total_nonneg p ord').
    cbn [app]. unfold low_at, after_low in *. cbn [Departs.low_at total] in *. destruct (Rle_dec u d); [lra |].
    rewrite IH by (auto; lra). unfold Departs.after_low. cbn [fold_left]. f_equal. ring.
Qed.

Lemma goes_on_app q : forall p r, goes_on r p -> goes_on (after_low p r) q -> goes_on r (p ++ q).
Proof.
  induction p as [| [d a] p IH]; intros r gp gq; [exact gq |].
  destruct gp as (f0 & e0 & gp). cbn [app]. unfold goes_on in *. cbn [Departs.goes_on]. split; [exact f0 |]. split; [exact e0 |].
  apply IH; auto.
Qed.

Lemma goes_on_end : forall p r, goes_on r p -> 0 <= speed (after_low p r).
Proof.
  induction p as [| [d a] p IH]; intros r g; [exact g |]. destruct g as (_ & _ & g). apply (IH _ g).
Qed.

(* D14 from below: what is inherited, the rest of the first period, the response. *)
Definition lowest (a : R) (p : part) :=
  let l := Rmin (low p) (weakest k a) in if later p then Rmin l (weakest k (ego_go k)) else l.

Definition legs_down (a : R) (late_ : bool) (parts : list part) :=
  map (fun p => (lasts p, lowest a p)) parts ++
  (if late_ then (shortest_period k, Rmin (weakest k a) (weakest k (ego_go k))) :: nil
   else (shortest_period k - response k, weakest k a) :: (response k, Rmin (weakest k a) (weakest k (ego_go k))) :: nil).

(* The clearing time and the speed then, of an ego that goes on. *)
Definition longest (r : reach) (target : R) := Rmax (target - distance r) 0 / cap.
Definition goes_until (r : reach) (target : R) := until (faded cap r (fade * longest r target)) target (weakest k (ego_go k)) cap.
Definition clears (r : reach) (target : R) := fst (goes_until r target) + shortest_period k + response k.

Variables (theta : R) (s v x pull : R -> R) (tau c : nat -> R).
Hypothesis m : motion s v.
Hypothesis drive : drives k theta v x pull tau c.
Hypothesis held : goes_with (fun t => - v t) (fun t => - x t) (fun t => - pull t) (- cap).
Hypothesis grid : exists start, forall i,
  start + INR i * period k - jitter k <= tau i <= start + INR i * period k + jitter k.
Hypothesis numbers : drivable k.
Hypothesis go0 : 0 < weakest k (ego_go k).

Variables (i n count : nat) (a sensed target most_ : R) (parts : list part) (late_ : bool).
Let T := tau (S i).
Let E := tau (S (S i) + count)%nat.
Let sp := shortest_period k.
Let rs := response k.
Let g := weakest k (ego_go k).
Hypothesis inherited : inherits k theta x pull tau c i 0 parts.
Hypothesis lateness : if late_ then sp <= rs else rs <= sp.
Hypothesis first : c (S i) = a.
(* Its go is not reduced. *)
Hypothesis goes_ : forall q, (q < count)%nat -> (q < n)%nat -> c (S (S i) + q)%nat = ego_go k.
Hypothesis hardest_ : weakest k a <= most_ /\ g <= most_ /\ 0 <= most_.

Let r0 := start (sensed - speed_error k).
Let legs := legs_down a late_ parts.
Let r3 := after_low legs r0.
Let until_ := fst (goes_until r3 target).
Let fast := snd (goes_until r3 target).

Hypothesis on_the_way : goes_on r0 legs.
Hypothesis sensed_ : sensed - speed_error k <= v T.
Hypothesis in_time : clears r3 target <= sp + INR n * period k.

Let E' := Rmin E (T + clears r3 target).

Lemma pulled_low t t' q : T <= t -> t <= t' -> t' <= E' ->
  (forall j, (j <= i)%nat -> t < tau (S j) + latency k -> q <= weakest k (c j)) ->
  (t < T + sp + switching k -> q <= weakest k a) -> (T + sp < t' -> q <= g) -> q * (t' - t) <= pull t' - pull t.
Proof.
  intros lo le hi old now_ go.
  assert (hE : t' <= E /\ t' <= T + sp + INR n * period k).
  { unfold E' in hi. pose proof (Rmin_l E (T + clears r3 target)). pose proof (Rmin_r E (T + clears r3 target)). lra. }
  assert (begun : tau 1%nat <= T) by (apply (tau_grows k tau grid numbers); lia).
  apply (pulls_down _ _ _ _ _ _ _ drive); [lra | exact le |].
  intros j j1 j2. destruct (le_lt_dec j i) as [e | l]; [apply old; auto |].
  destruct (Nat.eq_dec j (S i)) as [now | ne].
  { rewrite now in j2 |- *. rewrite first. apply now_. pose proof (turn k tau grid i 0) as H.
    rewrite Nat.add_0_r in H. simpl INR in H. unfold sp, T. lra. }
  set (q' := (j - S (S i))%nat). assert (J : j = (S (S i) + q')%nat) by (unfold q'; lia).
  assert (cnt : (q' < count)%nat).
  { destruct (le_lt_dec count q') as [bad |]; [exfalso | assumption].
    pose proof (tau_grows k tau grid numbers (S (S i) + count) j ltac:(lia)). unfold E in hE. lra. }
  pose proof (turn k tau grid i q') as [t1 _]. rewrite <- J in t1. fold T sp in t1.
  assert (p0 : 0 < period k) by apply numbers.
  assert (q0 : 0 <= INR q' * period k) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  assert (qn : (q' < n)%nat).
  { destruct (le_lt_dec n q') as [bad |]; [exfalso | assumption].
    assert (INR n * period k <= INR q' * period k) by (apply Rmult_le_compat_r; [lra | apply le_INR, bad]). lra. }
  rewrite J, goes_ by assumption. apply go. lra.
Qed.

Let last_ := Rmax (longest r3 target) until_.
Let all := legs ++ (last_, g) :: nil.

Lemma r3_moves : 0 <= speed r3.
Proof. apply goes_on_end, on_the_way. Qed.

Lemma faded_moves loss : 0 <= speed (faded cap r3 loss).
Proof. cbn. pose proof r3_moves. apply Rmin_glb; [assumption |]. apply Rle_trans with (2 := Rmax_l _ _). lra. Qed.

Lemma longest_nonneg : 0 <= longest r3 target.
Proof. unfold longest. apply Rmult_le_pos; [apply Rmax_r | left; apply Rinv_0_lt_compat; lra]. Qed.

(* What the code lets the ego lose before it goes is what it may lose in the last leg. *)
Lemma fades_so : speed (faded cap r3 (fade * last_)) = speed (faded cap r3 (fade * longest r3 target)) /\ 0 <= until_.
Proof.
  set (f := faded cap r3 (fade * longest r3 target)).
  destruct (until_is f target g cap go0 cap0 (faded_moves _)) as (ramp & steady & U & ra0 & st0 & V1 & V2 & W & V3).
  assert (u_ : until_ = ramp + steady) by exact U.
  split; [| lra]. unfold last_. destruct (Rle_dec until_ (longest r3 target)) as [le | gt].
  { rewrite Rmax_left by lra. reflexivity. }
  rewrite Rmax_right by lra.
  destruct (Rle_dec (speed r3) cap) as [slow | quick].
  { assert (same : forall loss, 0 <= loss -> speed (faded cap r3 loss) = speed r3).
    { intros loss l0. cbn. apply Rmin_left. apply Rle_trans with (2 := Rmax_l _ _). exact slow. }
    pose proof longest_nonneg. unfold f. rewrite !same; [reflexivity | |]; apply Rmult_le_pos; lra. }
  exfalso. apply gt. rewrite u_.
  assert (fc : cap <= speed f) by (unfold f; cbn; apply Rmin_glb; [lra | apply Rmax_l]).
  rewrite (Rmax_right cap) in * by lra.
  set (V := snd (until f target g cap)) in *. fold g in V1.
  assert (gr : g * ramp <= 0) by lra. assert (r_ : ramp = 0) by (unfold g in *; nra).
  rewrite r_ in *. replace (distance f) with (distance r3) in W by reflexivity.
  unfold longest. apply Rmult_le_reg_r with cap; [lra |].
  replace (Rmax (target - distance r3) 0 / cap * cap) with (Rmax (target - distance r3) 0) by (field; lra).
  rewrite <- W. assert (cap * steady <= speed f * steady) by (apply Rmult_le_compat_r; lra). lra.
Qed.

Lemma times_ : 0 < sp /\ 0 <= switching k /\ rs = switching k + ego_lag k /\ 0 <= ego_lag k /\ 0 <= INR n * period k.
Proof. apply (times k numbers n). Qed.

Lemma legs_down_total : total legs = sp + rs.
Proof.
  unfold legs, legs_down. rewrite total_app.
  assert (ps : forall l o, inherits k theta x pull tau c i o l -> total (map (fun p => (lasts p, lowest a p)) l) = rs - o).
  { induction l as [| p l IH]; intros o inh; cbn; [cbn in inh; unfold rs; lra |].
    destruct inh as (_ & _ & _ & _ & more). rewrite (IH _ more). ring. }
  rewrite (ps parts 0 inherited). unfold sp, rs. destruct late_; cbn; ring.
Qed.

Lemma all_low : legs_low k theta x pull T E' 0 all.
Proof.
  destruct times_ as (sp0 & sw0 & rsd & lag0 & n0).
  assert (th : 0 <= theta) by (apply (follows _ _ _ _ _ _ _ drive)).
  assert (gone : forall t j, T + rs - ego_lag k <= t -> (j <= i)%nat -> t < tau (S j) + latency k -> False).
  { intros t j lo. apply (old_gone k tau grid numbers i n t j). exact lo. }
  unfold all, legs, legs_down. change (shortest_period k) with sp. change (response k) with rs.
  change (weakest k (ego_go k)) with g. rewrite <- app_assoc.
  set (last_leg := Rmin (weakest k a) g).
  assert (L : last_leg <= weakest k a /\ last_leg <= g) by (split; [apply Rmin_l | apply Rmin_r]). destruct L as [L1 L2].
  assert (d_last : 0 <= last_) by (unfold last_; pose proof longest_nonneg; pose proof (Rmax_l (longest r3 target) until_); lra).
  assert (tail : legs_low k theta x pull T E' rs
    ((if late_ then (sp, last_leg) :: nil else (sp - rs, weakest k a) :: (rs, last_leg) :: nil) ++ (last_, g) :: nil)).
  { assert (go_leg : leg_low k theta x pull T E' (sp + rs) (last_, g)).
    { split; [exact d_last |]. cbn [fst snd]. split; [| lra]. intros t t' ? ? ? ? ?. apply pulled_low; auto; try lra.
      intros j ? ?. exfalso. apply (gone t j); lra || auto. }
    assert (drop : forall t t' o, T <= t -> T + o - ego_lag k <= t -> t <= t' -> t' <= E' -> rs <= o ->
              last_leg * (t' - t) <= pull t' - pull t).
    { intros t t' o ? ? ? ? ?. apply pulled_low; auto; try lra. intros j ? ?. exfalso. apply (gone t j); lra || auto. }
    assert (rest_ : forall t t', T <= t -> T + rs - ego_lag k <= t -> t <= t' -> t' <= T + sp -> t' <= E' ->
              weakest k a * (t' - t) <= pull t' - pull t).
    { intros t t' ? ? ? ? ?. apply pulled_low; auto; try lra. intros j ? ?. exfalso. apply (gone t j); lra || auto. }
    pose proof lateness as lateness_. clear - go_leg drop rest_ lateness_ sp0 lag0 rsd sw0 L1 L2.
    destruct late_; cbn [app legs_low fst].
    - split; [| split; [replace (rs + sp) with (sp + rs) by ring; exact go_leg | exact I]].
      split; [cbn; lra |]. cbn [fst snd]. split; [| lra]. intros t t' ? ? ? ? ?. apply (drop t t' rs); auto. lra.
    - replace (rs + (sp - rs)) with sp by ring. split; [| split; [| split; [exact go_leg | exact I]]].
      + split; [cbn; lra |]. cbn [fst snd]. split; [| lra]. intros t t' ? ? ? ? ?. apply rest_; auto; lra.
      + split; [cbn; lra |]. cbn [fst snd]. split; [| lra]. intros t t' ? ? ? ? ?. apply (drop t t' sp); auto; lra. }
  assert (each : forall ps o, inherits k theta x pull tau c i o ps -> 0 <= o ->
    legs_low k theta x pull T E' o (map (fun p => (lasts p, lowest a p)) ps ++
      ((if late_ then (sp, last_leg) :: nil else (sp - rs, weakest k a) :: (rs, last_leg) :: nil) ++ (last_, g) :: nil))).
  { induction ps as [| p ps IH]; intros o inh o0; cbn [map app].
    { cbn in inh. fold rs in inh. rewrite inh. exact tail. }
    destruct inh as (d0 & early & old & acc & more). cbn [legs_low fst].
    split; [| apply IH; [exact more | lra]].
    assert (h1 : lowest a p <= low p /\ lowest a p <= weakest k a).
    { unfold lowest. destruct (later p); cases; lra. }
    assert (h2 : later p = true -> lowest a p <= g) by (intros e; unfold lowest; rewrite e; apply Rmin_r).
    destruct h1 as [h0 h1].
    split; [exact d0 |]. cbn [fst snd]. split.
    - intros t t' ? ? ? ? ?. apply pulled_low; auto; try lra.
      + intros j j1 j2. unfold T in *. destruct (old j j1 ltac:(lra)). lra.
      + intros hi. apply h2. destruct (later p) eqn:l; [reflexivity | specialize (early eq_refl); fold sp in early; lra].
    - intros soon. destruct (acc soon) as [A _]. fold T in A. apply Rle_trans with (2 := A). apply Rmult_le_compat_l; lra. }
  apply each; [exact inherited | lra].
Qed.

Lemma all_go_on : goes_on r0 all.
Proof.
  unfold all. apply goes_on_app; [exact on_the_way |]. fold r3. unfold goes_on. cbn [Departs.goes_on].
  pose proof (faded_moves (fade * last_)) as f0.
  assert (e0 : 0 <= in_leg cap fade r3 last_ g last_).
  { unfold in_leg. apply Rmin_glb; [| apply Rle_trans with (2 := Rmax_r _ _); exact f0].
    assert (0 <= g * last_); [| lra]. apply Rmult_le_pos; [unfold g; lra |].
    unfold last_. pose proof longest_nonneg. pose proof (Rmax_l (longest r3 target) until_). lra. }
  split; [exact f0 |]. split; [exact e0 |]. rewrite slower_speed by assumption. exact e0.
Qed.

Lemma legs_ordered : ordered legs /\ ordered all /\ legs <> nil.
Proof.
  pose proof (low_ordered _ _ _ _ _ _ _ _ all_low) as O. unfold all in O.
  split; [apply Forall_app in O; apply O |]. split; [exact O |].
  unfold legs, legs_down. destruct late_; intros e; apply app_eq_nil in e; destruct e; discriminate.
Qed.

Theorem clears_where_planned :
  (T + clears r3 target <= E -> target <= s (T + clears r3 target) - s T) /\
  forall u, T <= u <= E -> u <= T + clears r3 target ->
    fast <= v u + most_ * (T + clears r3 target - u) /\ fast <= Rmax cap (v u).
Proof.
  destruct times_ as (sp0 & sw0 & rsd & lag0 & n0). destruct legs_ordered as (ord & ord_all & some).
  destruct fades_so as [same u0]. pose proof longest_nonneg as l0.
  pose proof legs_down_total as tot.
  assert (tot_all : total all = sp + rs + last_) by (unfold all; rewrite total_app, tot; cbn; ring).
  assert (cl : clears r3 target = until_ + sp + rs) by reflexivity.
  assert (ul : until_ <= last_) by apply Rmax_r.
  set (f := faded cap r3 (fade * longest r3 target)) in *.
  destruct (until_is f target g cap go0 cap0 (faded_moves _)) as (ramp & steady & U & ra0 & st0 & V1 & V2 & W & V3).
  change (fst (until f target g cap)) with until_ in U. change (snd (until f target g cap)) with fast in V1, V2, W, V3.
  set (C := Rmax cap (speed f)) in *.
  assert (rr0 : speed r0 <= v T) by (unfold r0; cbn; pose proof (forwards s v m T); cases; lra).
  assert (slow : forall u, T <= u <= E' -> low_at r0 all (u - T) <= v u).
  { intros u [? ?]. apply (no_slower k cap fade floor floor0 theta v x pull T E'); auto.
    - apply (follows _ _ _ _ _ _ _ drive).
    - apply (constant_known _ _ _ _ _ _ _ drive).
    - apply all_low.
    - apply all_go_on.
    - rewrite tot_all. unfold E' in *. pose proof (Rmin_r E (T + clears r3 target)). lra. }
  assert (leg_end : forall d, 0 <= d <= last_ -> in_leg cap fade r3 last_ g d = Rmin (speed f + g * d) C).
  { intros d ?. unfold in_leg, C. rewrite same. reflexivity. }
  split.
  - intros hE. set (T3 := T + (sp + rs)).
    assert (e' : E' = T + clears r3 target) by (unfold E'; apply Rmin_right; exact hE).
    destruct (legs_go cap fade floor floor0 s v m (s T) legs r0 T ord on_the_way) as [s3 v3].
    { intros t [? ?]. rewrite tot in *. change (low_at r0 legs (t - T) <= v t).
      rewrite <- (low_at_app ((last_, g) :: nil) legs r0 (t - T) ord some) by (rewrite tot; lra). apply slow. lra. }
    { unfold r0. cbn. lra. }
    rewrite tot in s3, v3. fold T3 in s3, v3. change (Departs.after_low cap fade floor legs r0) with r3 in s3, v3.
    assert (go_low : forall t, T3 <= t <= T3 + until_ -> Rmin (speed f + g * (t - T3)) C <= v t).
    { intros t [? ?]. destruct (Req_dec t T3) as [-> | ne].
      - apply Rle_trans with (1 := Rmin_l _ _). replace (T3 - T3) with 0 by ring.
        assert (speed f <= speed r3) by (unfold f; cbn; apply Rmin_l). lra.
      - rewrite <- leg_end by lra.
        pose proof (slow t ltac:(unfold T3 in *; lra)) as B. unfold all in B.
        rewrite low_at_beyond in B by (auto; rewrite tot; unfold T3 in *; lra). fold r3 in B. rewrite tot in B.
        replace (t - T - (sp + rs)) with (t - T3) in B by (unfold T3; ring).
        unfold low_at in B. cbn [Departs.low_at] in B. destruct (Rle_dec (t - T3) last_); [exact B | lra]. }
    assert (A : (speed f + fast) * ramp * (1 / 2) <= s (T3 + ramp) - s T3).
    { pose proof (above_line s v (speed f) g T3 (T3 + ramp) m ltac:(lra)) as HH.
      replace ((speed f + fast) * ramp * (1 / 2))
        with (speed f * (T3 + ramp - T3) + g * (T3 + ramp - T3) * (T3 + ramp - T3) / 2) by (rewrite V1; field).
      apply HH. intros t [? ?]. apply Rle_trans with (2 := go_low t ltac:(lra)).
      apply Rmin_glb; [lra |]. assert (g * (t - T3) <= g * ramp) by (apply Rmult_le_compat_l; [unfold g |]; lra). lra. }
    assert (B : C * steady <= s (T3 + ramp + steady) - s (T3 + ramp)).
    { destruct (Req_dec steady 0) as [z | nz].
      - rewrite z. replace (T3 + ramp + 0) with (T3 + ramp) by ring. lra.
      - pose proof (above_line s v C 0 (T3 + ramp) (T3 + ramp + steady) m ltac:(lra)) as HH.
        replace (C * steady) with (C * (T3 + ramp + steady - (T3 + ramp)) +
          0 * (T3 + ramp + steady - (T3 + ramp)) * (T3 + ramp + steady - (T3 + ramp)) / 2) by field.
        apply HH. intros t [? ?]. apply Rle_trans with (2 := go_low t ltac:(lra)).
        specialize (V3 ltac:(lra)).
        assert (g * ramp <= g * (t - T3)) by (apply Rmult_le_compat_l; [unfold g |]; lra). apply Rmin_glb; lra. }
    replace (T + clears r3 target) with (T3 + ramp + steady) by (rewrite cl, U; unfold T3; ring).
    pose proof (Rmax_l (target - distance f) 0). replace (distance f) with (distance r3) in * by reflexivity. lra.
  - intros u [lo hi] le.
    assert (h : E' >= u) by (unfold E'; apply Rle_ge, Rmin_glb; lra).
    pose proof (slow u ltac:(lra)) as B.
    assert (hard : List.Forall (fun leg : R * R => snd leg <= most_) all).
    { assert (both : forall x, Rmin (weakest k a) x <= most_) by (intros; apply Rle_trans with (1 := Rmin_l _ _), hardest_).
      unfold all, legs, legs_down. rewrite !Forall_app. split; [split |].
      - apply Forall_map, Forall_forall. intros p _. cbn. unfold lowest.
        assert (Rmin (low p) (weakest k a) <= most_) by (rewrite Rmin_comm; apply both).
        destruct (later p); [apply Rle_trans with (1 := Rmin_l _ _) |]; assumption.
      - clear - both hardest_. destruct hardest_ as [h _]. destruct late_;
          [apply Forall_cons; [apply both | apply Forall_nil]
          | apply Forall_cons; [exact h | apply Forall_cons; [apply both | apply Forall_nil]]].
      - apply Forall_cons; [apply hardest_ | apply Forall_nil]. }
    destruct (low_grows cap fade floor floor0 most_ all (proj2 (proj2 hardest_)) r0 ord_all all_go_on hard (u - T)
                (clears r3 target) ltac:(lra) ltac:(rewrite tot_all, cl; lra)) as [G1 G2].
    fold low_at in G1, G2.
    assert (V : fast <= low_at r0 all (clears r3 target)).
    { destruct (Req_dec until_ 0) as [z | nz].
      - assert (ramp = 0) by lra. assert (e : clears r3 target = total legs) by (rewrite cl, z, tot; ring). rewrite e.
        unfold all. rewrite low_at_app by (auto; lra).
        assert (last_speed : forall p r, ordered p -> goes_on r p -> p <> nil -> speed (after_low p r) <= low_at r p (total p)).
        { clear - floor0. induction p as [| [d q] p IH]; intros r op gp ne; [contradiction |].
          inversion op as [| ? ? d0 op']; subst. cbn [fst] in d0. destruct gp as (f0 & e0 & gp). pose proof (total_nonneg p op').
          destruct p as [| leg p].
          - unfold low_at, after_low. cbn [Departs.low_at total Departs.after_low fold_left]. rewrite Rplus_0_r.
            destruct (Rle_dec d d); [| lra]. right. apply slower_speed; assumption.
          - assert (some : leg :: p <> nil) by discriminate. set (p' := leg :: p) in *.
            change (after_low ((d, q) :: p') r) with (after_low p' (slower cap fade floor r (d, q))).
            apply Rle_trans with (1 := IH _ op' gp some). unfold low_at. cbn [Departs.low_at total].
            destruct (Rle_dec (d + total p') d) as [e | ne'].
            + assert (z : total p' = 0) by lra. rewrite z, Rplus_0_r.
              rewrite <- (slower_speed cap fade floor floor0 r d q e0). apply low_at_first, op'.
            + right. f_equal. ring. }
        apply Rle_trans with (2 := last_speed legs r0 ord on_the_way some). fold r3. rewrite V1, H. unfold f. cbn [faded speed].
        pose proof (Rmin_l (speed r3) (Rmax cap (speed r3 - fade * longest r3 target))). lra.
      - unfold all. rewrite low_at_beyond by (auto; rewrite tot, cl; lra). fold r3. rewrite tot, cl.
        replace (until_ + sp + rs - (sp + rs)) with until_ by ring.
        unfold low_at. cbn [Departs.low_at]. destruct (Rle_dec until_ last_); [| lra]. rewrite leg_end by lra.
        apply Rmin_glb; [| exact V2]. rewrite V1. assert (g * ramp <= g * until_) by (apply Rmult_le_compat_l; [unfold g |]; lra). lra. }
    replace (T + clears r3 target - u) with (clears r3 target - (u - T)) by ring.
    split; [lra |]. apply Rle_trans with (1 := V), Rle_trans with (1 := G2), Rle_max_compat_l. exact B.
Qed.
End Clears.
