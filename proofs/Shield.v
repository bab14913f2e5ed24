(* Theorem 1: the induction over periods, for every zone of every other. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart Entry.
Open Scope R_scope.

Lemma keeps_later k w from from' : from <= from' -> keeps_contract k w from -> keeps_contract k w from'.
Proof.
  intros le [r b]. split; intros u x y ? ? ?; [apply (r u) | apply (b u)]; lra.
Qed.

(* Time goes on with the calls. *)
Lemma call_after k tau i u : 0 < period k -> on_grid k tau -> exists m, u <= tau (i + m)%nat.
Proof.
  intros p0 grid.
  destruct (archimed ((u - tau i + 2 * jitter k) / period k)) as [A _].
  set (y := (u - tau i + 2 * jitter k) / period k) in *.
  exists (Z.to_nat (Z.max 0 (up y))).
  destruct (spacing k tau grid i (Z.to_nat (Z.max 0 (up y)))) as [L _].
  rewrite INR_IZR_INZ, Z2Nat.id in L by lia.
  assert (IZR (up y) <= IZR (Z.max 0 (up y))) by (apply IZR_le; lia).
  assert (E : y * period k = u - tau i + 2 * jitter k) by (unfold y; field; lra).
  assert (y * period k <= IZR (Z.max 0 (up y)) * period k) by (apply Rmult_le_compat_r; lra).
  lra.
Qed.

(* A call that is before a moment, and whose next one is not. *)
Lemma call_before k tau since u : 0 < period k -> on_grid k tau -> tau since < u ->
  exists i, (since <= i)%nat /\ tau i < u <= tau (S i).
Proof.
  intros p0 grid lo. destruct (call_after k tau since u p0 grid) as [m M]. induction m as [| m IH].
  - rewrite Nat.add_0_r in M. lra.
  - destruct (Rle_dec u (tau (since + m)%nat)) as [early | late]; [apply IH, early |].
    exists (since + m)%nat. split; [lia |]. replace (S (since + m)) with (since + S m)%nat by lia. lra.
Qed.

(* Every moment is between two calls. *)
Lemma between k tau since u : 0 < period k -> on_grid k tau -> tau since <= tau (S since) -> tau since <= u ->
  exists i, (since <= i)%nat /\ tau i <= u <= tau (S i).
Proof.
  intros p0 grid next lo. destruct (Req_dec (tau since) u) as [<- | ne]; [exists since; split; [lia | lra] |].
  destruct (call_before k tau since u p0 grid ltac:(lra)) as (i & hi & hu). exists i. split; [exact hi | lra].
Qed.

Lemma between_calls k tau (ok : valid k) (grid : on_grid k tau) since u : tau since <= u ->
  exists i, (since <= i)%nat /\ tau i <= u <= tau (S i).
Proof. apply (between k); [exact (period_pos k ok) | exact grid | apply (calls_ordered k tau ok grid); lia]. Qed.

Section Zone.
Variables (k : contract) (s v : R -> R) (tau c : nat -> R) (l : log).
Hypothesis ok : valid k.
Hypothesis ego_moves : motion s v.
Hypothesis grid : on_grid k tau.
Hypothesis obey : obeys k v tau c.
Hypothesis true : true_log k l s v tau c.

Variables (t w : R -> R) (b : nat -> bounds) (z : zone) (claimed : nat -> Prop) (since : nat).
Hypothesis other_moves : motion t w.
Hypothesis keeps : keeps_contract k w (tau since).
Hypothesis seen : forall i, (since <= i)%nat -> known k t w (tau since) (tau i) (b i).
Hypothesis starts : (1 <= since)%nat.
Hypothesis distance_kept : lane z = Datatypes.true -> keeps_distance k z s v t w (tau since).

Let in_order := calls_ordered k tau ok grid.

Lemma bounded i : (since <= i)%nat -> hold (b i) (t (tau i)) (w (tau i)).
Proof. intros h. apply (known_holds k t w (tau since)); auto. Qed.

Lemma truth i : (1 <= i)%nat ->
  own_holds k (ego_at l i) (s (tau i)) (v (tau i)) /\
  exists j, i = S j /\ previous_least l i <= c j <= previous_most l i /\ previous_most l i <= ego_acceleration k.
Proof.
  intros h. destruct i as [| j]; [lia |]. destruct (true j) as [A B]. split; [exact A | exists j; auto].
Qed.

Lemma gentle i x y : (1 <= i)%nat -> tau i <= x -> x <= y -> v x - ego_braking k * (y - x) <= v y.
Proof.
  intros h lo le. destruct i as [| j]; [lia |]. destruct (call_after k tau (S j) y (period_pos k ok) grid) as [m M].
  apply (ego_brakes_at_most k v tau c ok grid obey j m); auto.
Qed.

(** * A plan that is carried on *)

Section Carried.
Variables (i0 i : nat).
Hypothesis first : (since <= i0 <= i)%nat.
Hypothesis carried : forall j, (i0 <= j < i)%nat -> carries_on k l c j.

Let T := tau i0.
Let E := tau (S i).
Let o := ego_at l i0.
Let d := departs_at k l c i0.
Let n := goes l i0.

Lemma followed : plan_followed k v T E (previous_least l i0) (previous_most l i0) (c i0) n.
Proof.
  destruct (truth i0 ltac:(lia)) as (_ & j & -> & P & _).
  unfold T, E. replace (S i) with (S (S j) + (i - S j))%nat by lia.
  apply plan_is_followed; auto; [apply (forwards s v ego_moves) | |].
  - intros q. destruct (true q) as ((_ & [sensed_ _] & _) & _ & most_). lra.
  - intros q h. apply carried. lia.
Qed.

Lemma where_ : own_holds k o (s T) (v T).
Proof. apply truth. lia. Qed.

Lemma what : hold (b i0) (t T) (w T).
Proof. apply bounded. lia. Qed.

Lemma command_range : - ego_braking k <= c i0 <= ego_acceleration k /\ previous_least l i0 <= ego_acceleration k.
Proof.
  destruct (truth i0 ltac:(lia)) as (_ & j & _ & P).
  pose proof (commanded k v tau c obey i0). pose proof (commanded k v tau c obey j). lra.
Qed.

Lemma from_T : keeps_contract k w T.
Proof. apply keeps_later with (tau since); [apply in_order; lia | exact keeps]. Qed.

Lemma rest_bound u : T <= u <= E ->
  s u - s T + v u * v u / (ego_braking k + ego_braking k) <= rests k d n.
Proof.
  intros h. destruct where_ as (_ & vT & _). unfold d, departs_at. fold o.
  apply (plan_stops k s v T E); auto; [apply followed | apply command_range | lra].
Qed.

Lemma rest_place u : T <= u <= E -> s u - s T <= rests k d n.
Proof.
  intros h. pose proof (rest_bound u h).
  assert (0 <= v u * v u / (ego_braking k + ego_braking k)); [| lra].
  apply Rmult_le_pos; [apply Rle_0_sqr | left; apply Rinv_0_lt_compat; destruct ok; lra].
Qed.

Lemma rests_before u : stops k d n (stop_limit k z o) -> T <= u <= E -> s u < s_in z.
Proof.
  intros st h. destruct where_ as (sT & _). unfold stops, stops_short, stop_limit in st.
  pose proof (rest_place u h). assert (0 < slack k) by (destruct ok; lra). lra.
Qed.

Lemma rests_behind u : stops k d n (behind k z o (b i0)) -> T <= u <= E -> s u - t u <= lead_from z.
Proof.
  intros st h. destruct where_ as (sT & _). destruct what as [tT wT].
  unfold stops, stops_short, behind in st.
  assert (sl : 0 < slack k) by (destruct ok; lra).
  pose proof (rest_place T ltac:(lra)) as R0.
  destruct (Rlt_dec _ 0) as [not_behind | is_behind]; [lra |].
  set (gap := lead_from z - (own_s o + position_error k - t_least (b i0))) in *.
  rewrite earliest_rest_is in st. unfold rest_of, start in st. cbn in st.
  set (W := Rmax (w_least (b i0)) 0) in *.
  assert (W0 : 0 <= W <= w T).
  { pose proof (forwards t w other_moves T). unfold W. cases; lra. }
  assert (s u - t u <= s T - t T + gap); [| unfold gap in *; lra].
  apply (stays_behind k (ego_braking k) (ego_braking k) s v t w T E (rests k d n) gap W); auto; try lra; try (destruct ok; lra).
  - apply from_T.
  - intros x y ? ? ?. apply (gentle i0); auto. lia.
  - intros. apply rest_bound. lra.
Qed.

Lemma safe_by_passing u : passes k z o (b i0) d n -> T <= u <= E -> ~ inside z (s u) (t u).
Proof.
  intros [it spare] [lo hi] ((_ & sout) & (tin & _) & _).
  destruct where_ as (sT & vT & _). destruct what as [tT wT]. destruct command_range as [ca cp].
  assert (eps : 0 <= position_error k) by (destruct ok; lra).
  destruct (plan_clears k s v T E _ _ _ (own_v o) n ok ego_moves followed (s_out z - own_s o + 3 * position_error k)
              ltac:(destruct vT; lra) cp (proj2 ca) it) as (c0 & _ & gone & _).
  change (departure k (own_v o) (previous_least l i0) (previous_most l i0) (c i0)) with d in c0, gone.
  set (clears := fst (clearing k (least d) (s_out z - own_s o + 3 * position_error k))) in *.
  destruct (Rle_dec u (T + clears)) as [early | late].
  - pose proof (has_not_arrived k t w T u clears (t_in z - t_most (b i0)) (w_most (b i0)) (t_most (b i0)) ok other_moves
      from_T lo early ltac:(lra) ltac:(lra) spare). lra.
  - specialize (gone ltac:(lra)). pose proof (advances s v (T + clears) u ego_moves ltac:(lra)). lra.
Qed.

(* The ego enters a lane with a safe gap. *)
Lemma enters_ahead_safely u : enters k z o (b i0) d n -> T <= u <= E -> s_in z <= s u ->
  exists x, T <= x <= u /\ s_in z <= s x /\ (s T < s_in z -> s x = s_in z) /\
    safe_gap k (w x) (v x) + slack k <= s x - t x - lead_to z.
Proof.
  unfold enters. intros en [lo hi] inn.
  destruct where_ as (sT & vT & least_). destruct what as [tT wT]. destruct command_range as [ca cp].
  assert (eps : 0 <= position_error k) by (destruct ok; lra).
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  set (target := s_in z - own_s o + 3 * position_error k) in *.
  destruct (clearing k (least d) target) as [clears V] eqn:cl. destruct en as [it spare].
  destruct (plan_clears k s v T E _ _ _ (own_v o) n ok ego_moves followed target
              ltac:(destruct vT; lra) cp (proj2 ca) it) as (c0 & V0 & gone & slow).
  change (departure k (own_v o) (previous_least l i0) (previous_most l i0) (c i0)) with d in c0, V0, gone, slow.
  rewrite cl in *. cbn [fst snd] in *.
  assert (entry : exists x, T <= x <= u /\ x <= T + clears /\ Rmax (s_in z) (own_least o) <= s x /\
            (s T < s_in z -> s x = s_in z)).
  { destruct (Rle_dec (s_in z) (s T)) as [within | before].
    - exists T. split; [lra |]. split; [lra |]. split; [apply Rmax_lub; lra | lra].
    - assert (M : Rmax (s_in z) (own_least o) = s_in z) by (apply Rmax_left; lra). rewrite M.
      destruct (Rle_dec u (T + clears)) as [early | late].
      + destruct (Motion.passes s v T u (s_in z) ego_moves lo ltac:(lra)) as (x & ? & e). exists x. lra.
      + specialize (gone ltac:(lra)).
        destruct (Motion.passes s v T (T + clears) (s_in z) ego_moves ltac:(lra)) as (x & ? & e); [unfold target in gone; lra |].
        exists x. lra. }
  destruct entry as (x & [x1 x2] & x3 & at_ & exactly).
  pose proof (Rmax_l (s_in z) (own_least o)).
  exists x. split; [lra |]. split; [lra |]. split; [exact exactly |].
  pose proof (entry_sooner k (w_most (b i0)) (gap_ahead z o (b i0)) clears (x - T) (v x) V ok ltac:(lra)
    (forwards s v ego_moves x) V0) as G.
  replace (clears - (x - T)) with (T + clears - x) in G by ring.
  specialize (G (slow x ltac:(lra) x3) spare).
  destruct (rushing_holds t w (t T) (other_acceleration k) (other_max_speed k) (start (w_most (b i0))) T x other_moves a0 x1)
    as [B1 B2].
  { intros p q ? ? ?. apply (rushes k w T from_T x); lra. }
  { cbn. lra. }
  { cbn. cases; lra. }
  rewrite <- rush_is in B1, B2.
  pose proof (safe_gap_monotone k (w x) _ (v x) (v x) ok B2 (forwards s v ego_moves x) (Rle_refl _)) as M.
  unfold gap_ahead in G. lra.
Qed.

Lemma enters_safely u : enters k z o (b i0) d n -> T <= u <= E -> s_in z <= s u ->
  exists x, T <= x <= u /\ s_in z <= s x /\ safe k z (s x) (v x) (t x) (w x).
Proof.
  intros en hu inn. destruct (enters_ahead_safely u en hu inn) as (x & hx & sx & _ & gap).
  exists x. unfold safe. assert (0 < slack k) by (destruct ok; lra). split; [exact hx |]. split; [exact sx | lra].
Qed.
End Carried.

(** * Settled *)

(* Once the gap is safe in the lane, it stays open. *)
Lemma settled_for_ever x u : lane z = Datatypes.true -> tau since <= x -> x <= u -> s_in z <= s x ->
  safe k z (s x) (v x) (t x) (w x) -> ~ inside z (s u) (t u).
Proof.
  intros la lo le inn gap ((_ & sout) & (_ & tout) & _ & lead).
  destruct (distance_kept la x u lo le inn gap sout tout) as (x' & [x1 x2] & gap' & react).
  assert (lead_to z <= s u - t u); [| lra].
  apply (stays_ahead k s v t w z x' u); auto.
  - intros p q ? ? ?. apply (rushes k w _ keeps u); lra.
  - intros p q ? ? ?. apply (gentle since); auto. lra.
Qed.

Lemma safe_by_entering i0 i u : (since <= i0 <= i)%nat -> (forall j, (i0 <= j < i)%nat -> carries_on k l c j) ->
  lane z = Datatypes.true -> enters k z (ego_at l i0) (b i0) (departs_at k l c i0) (goes l i0) ->
  tau i0 <= u <= tau (S i) -> ~ inside z (s u) (t u).
Proof.
  intros h carried la en hu ins.
  destruct (enters_safely i0 i h carried u en hu ltac:(destruct ins as [[? _] _]; lra)) as (x & [x1 x2] & inn & gap).
  apply (settled_for_ever x u la); auto. apply Rle_trans with (tau i0); [apply in_order; lia | lra].
Qed.

Lemma settles_safely i :
  (lane z = Datatypes.true -> is_ahead k l b z since ->
     safe k z (s (tau since)) (v (tau since)) (t (tau since)) (w (tau since))) ->
  (since <= i)%nat -> settles k l c b z since i ->
  exists x, tau since <= x <= tau i /\ s_in z <= s x /\ safe k z (s x) (v x) (t x) (w x).
Proof.
  intros first_gap h (la & [inn half] & why).
  destruct (truth i ltac:(lia)) as ((sT & vT & least_) & _). destruct (bounded i h) as [tT wT].
  assert (lo : tau since <= tau i) by (apply in_order; lia).
  destruct why as [(i' & -> & i0 & [r1 r2] & [_ en] & carried) | [gap | ->]].
  - destruct (enters_safely i0 i' (conj r1 r2) carried (tau (S i')) en) as (x & [x1 x2] & ? & ?).
    + split; [apply in_order; lia | lra].
    + lra.
    + exists x. split; [| auto]. split; [| lra].
      apply Rle_trans with (tau i0); [apply in_order; lia | lra].
  - exists (tau i). split; [lra |]. split; [lra |]. unfold safe.
    pose proof (forwards s v ego_moves (tau i)).
    pose proof (safe_gap_monotone k (w (tau i)) (w_most (b i)) (v (tau i)) (Rmax (own_v (ego_at l i) - speed_error k) 0) ok
      ltac:(lra) (Rmax_r _ _) ltac:(cases; lra)).
    unfold gap_ahead in gap.
    assert (Rmax (s_in z) (own_least (ego_at l i)) <= s (tau i)) by (apply Rmax_lub; lra). lra.
  - exists (tau since). split; [lra |]. split; [lra |]. apply first_gap; [exact la | split; assumption].
Qed.

(* Who is no follower's leader (C6) is before the lane, or behind, or one of both has left; or it leads, or has led. *)
Lemma judged_outcome i u : lane z = Datatypes.true -> s (tau since) < s_in z -> (forall j, ~ claimed j) ->
  (since <= i)%nat -> judged k l c b z claimed since i -> tau i <= u <= tau (S i) ->
  s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
  exists x, tau since <= x <= u /\ s_in z <= s x /\ lead_to z <= s x - t x.
Proof.
  intros la before unclaimed h j [lo hi].
  destruct (truth i ltac:(lia)) as ((sT & vT & least_) & _). destruct (bounded i h) as [tT wT].
  assert (gap_open : forall x, safe k z (s x) (v x) (t x) (w x) -> lead_to z <= s x - t x).
  { intros x sf. unfold safe in sf. rewrite safe_gap_is in sf.
    pose proof (Rmax_r (rest_of (rush k (w x) (follower_reaction k)) (follower_braking k) - rest_of (start (v x)) (hardest k)) 0).
    lra. }
  destruct j as [[past | past] | [(i0 & [r1 r2] & se) | [(i0 & [r1 r2] & ver & carried) | (i0 & _ & [cl _] & _)]]].
  - right; right; left. pose proof (advances s v (tau i) u ego_moves lo). lra.
  - do 3 right; left. pose proof (advances t w (tau i) u other_moves lo). lra.
  - do 4 right. destruct (settles_safely i0) as (x & [x1 x2] & inn & gap); auto.
    + intros _ [least_in _]. exfalso. destruct (truth since ltac:(lia)) as ((_ & _ & ?) & _). lra.
    + assert (tau i0 <= tau i) by (apply in_order; lia). exists x. split; [lra |]. split; [exact inn | apply gap_open, gap].
  - assert (hu : tau i0 <= u <= tau (S i)) by (split; [apply Rle_trans with (tau i); [apply in_order; lia | lra] | lra]).
    destruct ver as [st | other_way]; [left; apply (rests_before i0 i (conj r1 r2) carried u st hu) |].
    rewrite la in other_way. destruct other_way as [st | en].
    + right; left. apply (rests_behind i0 i (conj r1 r2) carried u st hu).
    + destruct (Rlt_le_dec (s u) (s_in z)) as [out | inn]; [left; exact out |]. do 4 right.
      destruct (enters_safely i0 i (conj r1 r2) carried u en hu inn) as (x & [x1 x2] & ? & gap).
      exists x. split; [| split; [assumption | apply gap_open, gap]].
      split; [apply Rle_trans with (tau i0); [apply in_order; lia | lra] | lra].
  - destruct (unclaimed i0 cl).
Qed.

Hypothesis first_gap : lane z = Datatypes.true -> is_ahead k l b z since ->
  safe k z (s (tau since)) (v (tau since)) (t (tau since)) (w (tau since)).
Hypothesis yields : gives_way k z s tau l c t w claimed since.

(* D13: the other stays out of a zone that is opened. *)
Lemma safe_by_precedence i0 i u : (since <= i0 <= i)%nat -> opened_at k b z claimed i0 ->
  (forall j, (i0 <= j < i)%nat -> carries_on k l c j) -> tau i0 <= u <= tau (S i) -> ~ inside z (s u) (t u).
Proof.
  intros h (cl & stop) carried hu (_ & [tin _] & [_ led]).
  destruct (bounded i0 ltac:(lia)) as [tT wT]. pose proof (forwards t w other_moves (tau i0)) as w0.
  assert (t u <= t_in z \/ (lane z = Datatypes.true /\ lead_to z <= s u - t u)); [| lra].
  apply (yields i0 i h cl) with (u := u); auto.
  apply Rle_trans with (2 := stop). unfold rest_of. cbn.
  assert (0 < precedence_braking k) by (destruct ok; lra).
  assert (w (tau i0) * w (tau i0) / (precedence_braking k + precedence_braking k)
          <= w_most (b i0) * w_most (b i0) / (precedence_braking k + precedence_braking k)); [| lra].
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | apply Rmult_le_compat; lra].
Qed.

(* While a zone is judged at a call, ego and other are not inside of it until the next one. *)
Lemma judged_safe i u : (since <= i)%nat -> judged k l c b z claimed since i -> tau i <= u <= tau (S i) ->
  ~ inside z (s u) (t u).
Proof.
  intros h j [lo hi]. destruct (truth i ltac:(lia)) as ((sT & vT & least_) & _). destruct (bounded i h) as [tT wT].
  destruct j as [[past | past] | [(i0 & [r1 r2] & se) | [(i0 & [r1 r2] & ver & carried) | (i0 & [r1 r2] & open & carried)]]].
  - intros ((_ & ?) & _). pose proof (advances s v (tau i) u ego_moves lo). lra.
  - intros (_ & (_ & ?) & _). pose proof (advances t w (tau i) u other_moves lo). lra.
  - destruct (settles_safely i0 first_gap r1 se) as (x & [x1 x2] & inn & gap).
    assert (tau i0 <= tau i) by (apply in_order; lia).
    apply (settled_for_ever x u); auto; [apply se | lra].
  - assert (hu : tau i0 <= u <= tau (S i)) by (split; [apply Rle_trans with (tau i); [apply in_order; lia | lra] | lra]).
    destruct ver as [st | other_way].
    { intros [[? _] _]. pose proof (rests_before i0 i (conj r1 r2) carried u st hu). lra. }
    assert (which : lane z = Datatypes.true \/ lane z = false) by (destruct (lane z); auto).
    destruct which as [la | la]; rewrite la in other_way; [destruct other_way as [st | en] |].
    + intros (_ & _ & [? _]). pose proof (rests_behind i0 i (conj r1 r2) carried u st hu). lra.
    + apply (safe_by_entering i0 i u (conj r1 r2) carried la en hu).
    + apply (safe_by_passing i0 i (conj r1 r2) carried u other_way hu).
  - apply (safe_by_precedence i0 i u (conj r1 r2) open carried).
    split; [apply Rle_trans with (tau i); [apply in_order; lia | lra] | lra].
Qed.

End Zone.

Theorem verified_plans_keep_apart : Theorem1.
Proof.
  intros k path zones occupied s v tau c l others (ok & cov & em & grid & obey & true & keeps & judged_all) o u oo lo occ.
  destruct (cov (on o) (s u) (place o u) occ) as (z & zin & ins).
  destruct (keeps o oo) as [om c2 c3 c6 c7 a9 a11 st].
  destruct (between_calls k tau ok grid (since o) u lo) as (i & hi & hu).
  apply (judged_safe k s v tau c l) with (t := place o) (w := rate o) (b := view o (on o)) (z := z)
    (claimed := claims o (on o) z) (since := since o)
    (i := i) (u := u); auto.
Qed.
